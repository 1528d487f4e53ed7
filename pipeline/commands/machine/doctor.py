"""`symolo doctor`: checks what this machine has."""

from pathlib import Path

import typer

from pipeline.commands.exit_codes import MACHINE_LACKS
from pipeline.commands.options import (
    Json,
)


def doctor(*, as_json: Json = False) -> int:
    """Check this machine: Python, packages, system libraries, Blender, PyBullet, disk, cores, memory, graphics card.

    For each missing item, the command prints the line that installs it. If anything is missing, it ends with exit code
    5.

    Example: symolo doctor
    """
    from pipeline.doctor import examine

    checks = []
    for check in examine(Path.cwd()):
        if not as_json:
            typer.echo(str(check))
        checks.append(check)
    code = 0 if all(check.ok for check in checks) else MACHINE_LACKS
    if as_json:
        from pipeline.json_results.doctor import CheckPart, DoctorResult

        typer.echo(DoctorResult(exit_code=code, checks=[CheckPart.from_check(check) for check in checks]).to_json())
    return code
