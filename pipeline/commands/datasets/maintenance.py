"""Commands that maintain an output folder: status, repair."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.exit_codes import FAULTS
from pipeline.commands.options import Dataset, Json, Settings, Workers, checked_input


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

        typer.echo(StatusResult.of(str(folder), result, code).to_json())
        return code
    losses = losses_of(Workspace(folder.absolute()), loaded.tree, specs) if loaded else None
    for line in (*status_lines(result, losses, check=check), *code_file_lines(folder)):
        typer.echo(line)
    return code


def repair(
    folder: Dataset,
    *,
    remove_extra: Annotated[
        bool, typer.Option("--remove-extra", help="Remove files that do not belong to the release.")
    ] = False,
    workers: Workers = None,
) -> int:
    """Restore the damaged files of a dataset, and nothing else.

    Copies of a file elsewhere in the dataset or in .stages are used first. A run is simulated again only if its
    trajectory is lost, and only damaged frames are rendered again. A file is replaced only by one whose SHA-256 is
    that of the manifest. The exit code is 0 if every file is as it was released, and 4 if some files are not; each of
    them is named with the reason.

    Example: symolo repair data
    """
    from pipeline.repair.repair import repair as repaired
    from pipeline.run_folder.output import check_finished
    from pipeline.work.supervisor import cores
    from symolo.core.progress import plural, report_here

    check_finished(folder)
    result = repaired(folder, workers or cores(), report_here(), typer.echo, remove_extra=remove_extra)
    for fault in result.left:
        typer.echo(f"not repaired: {fault}")
    rest = f"{len(result.left)} left" if result.left else "every file is as it was released"
    typer.echo(f"{folder}: {plural(result.repaired, 'fault')} repaired, {rest}", err=bool(result.left))
    return FAULTS if result.left else 0
