"""Commands for a controller that runs on a board: hil, firmware."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.make.stages import conclude
from pipeline.commands.options import (
    OnDevice,
    Out,
    Replace,
    Robot,
    Scenario,
    Settings,
    WorkerMemory,
    Workers,
    checked_new_folder,
    names,
    with_device,
)
from symolo.core.errors import InputError
from symolo.core.text_enum import TextEnum


class FramingChoice(TextEnum):
    """Framings of the serial line."""

    FRAMED = "framed"
    SIMTWO = "simtwo"


Framing = Annotated[
    FramingChoice,
    typer.Option(
        "--framing",
        help="Format on the serial line: framed has sequence numbers and checksums; simtwo is the format of SimTwo.",
    ),
]
Baud = Annotated[
    int | None,
    typer.Option(
        "--baud",
        metavar="N",
        help="Baud rate: 115200, 250000, 500000 or 1000000; by default 500000, with --framing simtwo 115200.",
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
        typer.Option(
            "--simulated", help="Use a simulated ATmega2560 in lock-step, which gives the same data every time."
        ),
    ] = False,
    framing: Framing = FramingChoice.FRAMED,
    baud: Baud = None,
    settings: Settings = None,
    workers: Workers = None,
    device: OnDevice = None,
    memory: WorkerMemory = None,
    replace: Replace = False,
) -> int:
    """Make a dataset whose robot is driven by a microcontroller board (hardware in the loop).

    Example: symolo hil smoke --simulated --out data

    For a real board, write a sketch with `symolo firmware` and upload it to the board. Then start the robot: symolo hil
    smoke --port /dev/ttyACM0 --out data

    The same command continues after an interruption: finished runs are not driven again.
    """
    from pipeline.executors.local import Local
    from pipeline.run_folder.losses import check_losses, protected_runs
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
    check_losses(batch.workspace, batch.loaded.tree, batch.specs, report, replace=replace)
    check_board(batch.workspace, batch.specs, port or "")
    with batch.workspace.locked():
        protected = protected_runs(batch.workspace, batch.loaded.tree, batch.specs, report, replace=replace)
        for line in (*batch.notes, *again(batch.workspace, batch.specs)):
            report.say(line)
        batch.copy_user_images()
        failures = drive_runs(batch.workspace, batch.specs, port or "", report)
        failures += batch.render(failures, report)
        batch.assemble(failures, report, protected)
    return conclude(failures, len(batch.specs), "hil", out)


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
