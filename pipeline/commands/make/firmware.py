"""`symolo firmware`: writes the controller of the robot as an Arduino sketch."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.options import (
    Robot,
    checked_new_folder,
    names,
)
from pipeline.commands.serial_line import Baud, Framing, FramingChoice


def firmware(
    out: Annotated[
        Path,
        typer.Option(
            "--out",
            metavar="DIR",
            callback=checked_new_folder,
            help="New folder for the sketch; its name becomes that of the sketch.",
        ),
    ],
    *,
    robot: Robot = "nominal",
    framing: Framing = FramingChoice.FRAMED,
    baud: Baud = None,
    exercises: Annotated[
        str | None,
        typer.Option(
            metavar="NAME,...",
            help="Functions of student.c that students will write, such as line_error,follow; all means all of them.",
        ),
    ] = None,
) -> None:
    """Write the robot's controller as a sketch for an Arduino Mega 2560.

    Example: symolo firmware --out lap

    For a lesson: symolo firmware --out lesson --exercises line_error,follow
    """
    from configs.draw import draw_robot
    from configs.loader import load_section
    from configs.schema.board import Board
    from hil.build import student_tasks, write_sketch

    config, _ = draw_robot(load_section("robot", robot), 1, "bench")
    chosen = student_tasks() if exercises == "all" else names(exercises, "--exercises") if exercises else ()
    bits_per_s = Board(framing=framing.value, baud=baud).bits_per_s
    identity = write_sketch(config, out, framing.value, bits_per_s, chosen)
    typer.echo(f"firmware {identity} for robot {config.name}, {framing.value} at {bits_per_s} baud, in {out}")
