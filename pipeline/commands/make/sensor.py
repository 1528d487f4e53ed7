"""Commands for sensors, also a user's own: `symolo sensor new`, `check`, `list`, `show`, `extract`."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.options import checked_input
from pipeline.commands.user_files import NewCode, conclude_check, extract_command, write_template

HELP = "Write and check a sensor of your own, or look at those that there are."


def new(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of the kind of sensor, such as compass.")],
    *,
    out: NewCode = None,
) -> None:
    """Write a file with a sensor of your own to begin with, which `sensor check` accepts.

    Example: symolo sensor new compass
    """
    from pipeline.sensors.template import template

    file = write_template(name, out, template(name))
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
    trial = ["--sensor-file", str(file), "simulate", "smoke", "--set", checked.trial.setting]
    return conclude_check(file, check_text(checked), trial if checked.is_good else None)


def list_() -> None:
    """List all kinds of sensors that robot.sensors may contain, with their columns.

    Example: symolo sensor list
    """
    from pipeline.sensors.listing import sensor_lines

    for line in sensor_lines():
        typer.echo(line)
    typer.echo("`symolo sensor show NAME` explains the columns and the settings of one kind.")


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
