"""Commands for descriptions of robots: `symolo robot import`, `symolo robot show`."""

import re
import shlex
from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.options import absent_file_check, checked_input, read_input
from symolo.core.errors import InputError
from symolo.core.files.plain_files import FileKind

HELP = "Import the description of a robot, or show one with all of its numbers."


def import_(
    urdf: Annotated[
        Path, typer.Argument(metavar="FILE", callback=checked_input, help="URDF file of a robot with two wheels.")
    ],
    *,
    out: Annotated[
        Path,
        typer.Option("--out", metavar="ROBOT.yaml", callback=absent_file_check(".yaml"), help="Robot file to write."),
    ],
    wheels: Annotated[
        str | None,
        typer.Option(metavar="LEFT,RIGHT", help="Joints of the driven wheels; by default they are looked for."),
    ] = None,
) -> None:
    """Make a robot file from a URDF file, and list what was read and what had to be assumed.

    Example: symolo robot import turtlebot.urdf --out turtlebot.yaml

    Everything that a URDF file does not have, such as gains and range sensors, is that of the nominal robot, scaled.
    Then drive it: symolo simulate smoke --set robot=turtlebot.yaml --out data
    """
    from configs.loader import section_of
    from physics.robot.urdf_import import robot_from_urdf
    from physics.robot.urdf_tree import read_urdf
    from pipeline.robot_file import arena_settings, robot_file_text
    from symolo.core.files.atomic_files import write_file

    name = re.sub(r"[^A-Za-z0-9_-]", "_", out.stem)[:64]
    names = tuple(wheels.split(",")) if wheels else None
    if names is not None and len(names) != 2:
        raise InputError("--wheels", got=wheels, allowed="the names of two joints: LEFT,RIGHT")
    data = read_input(urdf, FileKind.DOCUMENT)
    pair = (names[0], names[1]) if names else None
    imported = robot_from_urdf(read_urdf(data, str(urdf)), name, str(urdf), pair)
    section_of("robot", imported.settings, f"{urdf}, imported")
    write_file(out, robot_file_text(imported, urdf.name).encode())
    for heading, lines in imported.lists():
        typer.echo(f"{heading}:")
        for line in lines:
            typer.echo(f"  - {line}")
    settings = " ".join(f"--set {shlex.quote(setting)}" for setting in (f"robot={out}", *arena_settings(imported)))
    typer.echo(f"{out}: try it with `symolo simulate smoke {settings} --out data`")


def show(
    robot: Annotated[str, typer.Argument(metavar="ROBOT", help="Name of a shipped robot, or a YAML file.")],
) -> None:
    """Print a robot with all of its numbers, after `extends` and `scale`.

    Example: symolo robot show micromouse
    """
    import yaml

    from configs.loader import load_section

    typer.echo(yaml.safe_dump(load_section("robot", robot).tree, sort_keys=False, allow_unicode=True).rstrip())


COMMANDS = (import_, show)
