"""Commands for sensors, also a user's own: `symolo sensor new`, `check`, `list`, `extract`."""

import shlex
from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.exit_codes import BAD_INPUT
from pipeline.commands.options import Dataset, NewFolder, absent_file_check, checked_input, if_given

HELP = "Write and check a sensor of your own, or look at those that there are."


def new(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of the kind of sensor, such as compass.")],
    *,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="FILE.py",
            callback=if_given(absent_file_check(".py")),
            help="File to write; by default NAME.py in this folder.",
        ),
    ] = None,
) -> None:
    """Write a file with a sensor of your own to begin with, which `sensor check` accepts.

    Example: symolo sensor new compass
    """
    from pipeline.sensors.template import template
    from symolo.core.files.atomic_files import write_file

    file = out or absent_file_check(".py")(Path(f"{name}.py"))
    write_file(file, template(name).encode())
    typer.echo(f"{file}: change it as you like, then: symolo sensor check {file}")


def check(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", callback=checked_input, help="Python file that defines a sensor.")
    ],
) -> int:
    """Check a file with a sensor of your own in short drives, and explain each rule.

    The exit code is 0 if the sensor keeps all rules, and 2 if not. The command executes the file: check only files that
    you have read.

    Example: symolo sensor check compass.py
    """
    from pipeline.sensors.check import check as checked_of
    from pipeline.sensors.check import check_text
    from symolo.core.extras import check_installed

    check_installed("pybullet")
    checked = checked_of(file)
    for line in check_text(checked):
        typer.echo(line)
    if checked.is_good:
        options = shlex.join(["--sensor-file", str(file), "simulate", "smoke", "--set", checked.trial.setting])
        typer.echo(f"{file} keeps every rule; try it: symolo {options} --out data")
        return 0
    typer.echo(f"symolo: {file}: breaks a rule, see above", err=True)
    return BAD_INPUT


def list_() -> None:
    """List all kinds of sensors that robot.sensors may contain, with their columns.

    Example: symolo sensor list
    """
    from pipeline.sensors.listing import sensor_lines

    for line in sensor_lines():
        typer.echo(line)


def extract(folder: Dataset, *, out: NewFolder) -> None:
    """Write the files of the sensors that a dataset was made with, to be read before they are used.

    No command executes code of a dataset. To make its runs again, read the files, and then name them: symolo
    --sensor-file FILE repair DIR.

    Example: symolo sensor extract data --out sensors
    """
    from configs.user_files import SENSOR_FILES
    from pipeline.code_files import extracted

    for file in extracted(folder, out, SENSOR_FILES):
        typer.echo(out / file)


COMMANDS = (new, check, list_, extract)
