"""The command `symolo measured`: what is in measured data, before anything is made of it."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.options import checked_input


def measured(
    case: Annotated[
        Path,
        typer.Argument(
            metavar="CASE",
            callback=checked_input,
            help="Case folder, log, run of a dataset, or table-1, table-3, table-4 of the paper.",
        ),
    ],
    *,
    as_: Annotated[
        str | None,
        typer.Option("--as", metavar="NAME", help="Importer to read it with; by default the one that recognises it."),
    ] = None,
) -> None:
    """Say what was read from a robot's log: trials, rates, gaps, and each channel's missing and wild samples and noise.

    CASE is a folder with nominal.yaml and data.csv (motor_steady, motor_step, tof_bench, drive_log), a run folder or
    data.csv of a SyMoLo dataset, or a file or folder of OptiOdom, Algernon, Robotino or VL53L0X data. Nothing is
    written, nothing is mended: a file that is not as it should be is refused with file, row and column, exit code 2.

    Columns: rows, those MISSING, with NO TARGET and STALE, WILD ones (6 sigma off their neighbours, or off the known
    distance), smallest and largest good value, smallest step, NOISE as found in the data (standard deviation, and
    correlation from row to row or number of repeats), KNOWN as the source states it.

    Example: symolo measured my_robot/drive_1
    """
    from diagnosis.importers.choose import read_measurement
    from diagnosis.measured.overview import overview
    from pipeline.importers import IMPORTERS

    for line in overview(read_measurement(case, IMPORTERS, as_)):
        typer.echo(line)
