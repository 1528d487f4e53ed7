"""`symolo status`: shows what an output folder contains and what the next release would do."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.exit_codes import FAULTS
from pipeline.commands.options import Json, Settings, checked_input


def status(
    folder: Annotated[Path, typer.Argument(metavar="DIR", callback=checked_input, help="Output folder of a release.")],
    scenario: Annotated[
        str | None,
        typer.Argument(metavar="SCENARIO", help="Scenario that would be released next; by default the stored one."),
    ] = None,
    *,
    settings: Settings = None,
    check: Annotated[bool, typer.Option("--check", help="Also hash every file, to detect damage.")] = False,
    as_json: Json = False,
) -> int:
    """Show what an output folder contains, what failed, and what the next release would do and why.

    The command also shows whether another command works in the folder, and how much disk space the folder uses. It
    changes nothing. The exit code is 4 if --check detects missing or changed files, and 0 otherwise.

    Example: symolo status data symolo --set look.sun.elevation_deg=60
    """
    from configs.loader import load_scenario
    from pipeline.code_files import code_file_lines
    from pipeline.planning.drawing import draw_reported
    from pipeline.run_folder.losses import losses_of
    from pipeline.run_folder.status import status as status_of
    from pipeline.run_folder.status_text import status_lines
    from pipeline.run_folder.workspace import Workspace
    from symolo.core.errors import InputError
    from symolo.core.progress import report_here

    if settings and scenario is None:
        raise InputError("--set", got=settings[0], cure="name the scenario that it applies to")
    loaded = load_scenario(scenario, settings or ()) if scenario is not None else None
    specs = draw_reported(loaded, report_here()) if loaded else ()
    result = status_of(folder, specs, check=check)
    code = FAULTS if check and result.is_damaged else 0
    if as_json:
        from pipeline.json_results.status import StatusResult

        typer.echo(StatusResult.from_status(str(folder), result, code).to_json())
        return code
    losses = losses_of(Workspace(folder.absolute()), loaded.tree, specs) if loaded else None
    for line in (*status_lines(result, losses, check=check), *code_file_lines(folder)):
        typer.echo(line)
    return code
