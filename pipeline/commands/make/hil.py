"""`symolo hil`: makes a dataset whose robot is driven by a controller board."""

from typing import Annotated

import typer

from pipeline.commands.options import (
    OnDevice,
    Out,
    Replace,
    Scenario,
    Settings,
    WorkerMemory,
    Workers,
    with_device,
)
from pipeline.commands.serial_line import Baud, Framing, FramingChoice
from pipeline.commands.stages import conclude
from symolo.core.errors import InputError


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
    batch = Batch.open(scenario, overrides, out, Local.from_options(workers, memory), report)
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
