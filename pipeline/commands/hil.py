"""Commands for a controller that runs on a board: hil, firmware."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.options import (
    OnDevice,
    Out,
    Robot,
    Scenario,
    Settings,
    WorkerMemory,
    Workers,
    checked_new_folder,
    names,
    with_device,
)
from pipeline.commands.stages import conclude
from symolo.core.errors import InputError
from symolo.core.text_enum import TextEnum


class FramingChoice(TextEnum):
    """How the bytes are put together."""

    FRAMED = "framed"
    SIMTWO = "simtwo"


Framing = Annotated[
    FramingChoice,
    typer.Option("--framing", help="framed has sequence numbers and CRC-16; simtwo is that of SimTwo's channels."),
]
Baud = Annotated[
    int | None,
    typer.Option(
        "--baud",
        metavar="N",
        help="Bits per second: 115200, 250000, 500000 or 1000000. By default 500000, with --framing simtwo 115200.",
    ),
]


def hil(
    scenario: Scenario,
    out: Out,
    *,
    port: Annotated[
        str | None, typer.Option("--port", metavar="PORT", help="Serial port of a real board, such as /dev/ttyACM0.")
    ] = None,
    simulated: Annotated[
        bool,
        typer.Option("--simulated", help="A simulated ATmega2560 instead, in lock-step: the same data every time."),
    ] = False,
    framing: Framing = FramingChoice.FRAMED,
    baud: Baud = None,
    settings: Settings = None,
    workers: Workers = None,
    device: OnDevice = None,
    memory: WorkerMemory = None,
) -> int:
    """Hardware in the loop: a board drives the robot, everything else is a release as any other.

    Example: symolo hil smoke --simulated --out data

    With a real one: symolo firmware --out lap, flash the sketch, then symolo hil smoke --port /dev/ttyACM0 --out data

    Given again it continues: runs that were driven are kept.
    """
    from pipeline.executors.local import Local
    from pipeline.run_folder.status import again
    from pipeline.stages.board_runs import check_board, drive_runs
    from pipeline.work.batch import Batch
    from symolo.core.progress import report_here

    if (port is None) is not simulated:
        raise InputError("--port" if port is not None else "--simulated", allowed="either --port PORT or --simulated")
    board = [f"board.kind={'simulated' if simulated else 'serial'}", f"board.framing={framing}"]
    overrides = with_device([*(settings or ()), *board, *([f"board.baud={baud}"] if baud else [])], device)
    report = report_here()
    batch = Batch.open(scenario, overrides, out, Local.of(workers, memory), report)
    check_board(batch.workspace, batch.specs, port or "")
    with batch.workspace.locked():
        for line in again(batch.workspace, batch.specs):
            report.say(line)
        batch.keep_user_files()
        failures = drive_runs(batch.workspace, batch.specs, port or "", report)
        failures += batch.render(failures, report)
        batch.assemble(failures, report)
    return conclude(failures, len(batch.specs), "hil", out)


def firmware(
    out: Annotated[
        Path,
        typer.Option(
            "--out",
            metavar="DIR",
            callback=checked_new_folder,
            help="Folder of the sketch, which must not be there yet; its name becomes that of the sketch.",
        ),
    ],
    *,
    robot: Robot = "nominal",
    framing: Framing = FramingChoice.FRAMED,
    baud: Baud = None,
    todo: Annotated[
        str | None,
        typer.Option(
            metavar="NAME,...",
            help="Functions of student.c that are left to be written, such as line_error,follow; `all` for every one.",
        ),
    ] = None,
) -> None:
    """Write the robot's controller as a sketch for an Arduino Mega 2560, ready to be flashed.

    Example: symolo firmware --out lap

    For a lesson: symolo firmware --out lesson --todo line_error,follow
    """
    from configs.draw import draw_robot
    from configs.loader import load_section
    from configs.schema.board import Board
    from hil.build import student_tasks, write_sketch

    config, _ = draw_robot(load_section("robot", robot), 1, "bench")
    left = student_tasks() if todo == "all" else names(todo, "--todo") if todo else ()
    bits_per_s = Board(framing=framing.value, baud=baud).bits_per_s
    identity = write_sketch(config, out, framing.value, bits_per_s, left)
    typer.echo(f"firmware {identity} for robot {config.name}, {framing.value} at {bits_per_s} baud, in {out}")
