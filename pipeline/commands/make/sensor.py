"""Commands for sensors, also a user's own: `symolo sensor new`, `check`, `list`, `show`, `extract`."""

import shlex
from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.exit_codes import BAD_INPUT
from pipeline.commands.extract import extract_command
from pipeline.commands.options import absent_file_check, checked_input, if_given

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


def show(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of a kind of sensor.")],
) -> None:
    """Show a kind of sensor with its columns, its settings with bounds and defaults, and where it is defined.

    Example: symolo sensor show lidar

    A sensor of your own: symolo --sensor-file compass.py sensor show compass
    """
    from pipeline.sensors.listing import sensor_text
    from sensors.registry import SENSORS

    for line in sensor_text(SENSORS.named(name)):
        typer.echo(line)


COMMANDS = (new, check, list_, show, extract_command("sensor"))
