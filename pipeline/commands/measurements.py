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
        typer.Option("--as", metavar="NAME", help="Read it as this kind of data; a name that is none lists them."),
    ] = None,
) -> None:
    """Say what is in the log of a real robot or bench, before anything is made of it.

    CASE is one of these; which one is seen from its files:

    - a case folder: nominal.yaml and data.csv, kinds motor_steady,
      motor_step, tof_bench and drive_log (docs/measured.md)

    - a run folder or release of symolo, or a SyMoLo data.csv

    - a file or folder of OptiOdom, Algernon, Robotino or VL53L0X data

    - table-1, table-3 or table-4 of the paper

    Printed are trials with rates and gaps, then for each channel: rows;
    missing, without target, stale (an old value said again) and wild ones
    (6 sigma off their neighbours, or off the known distance); smallest
    and largest good value; the step that all lie on; noise as found in
    the data, with its correlation from row to row or the number of
    repeats it rests on; noise as the source states it.

    Nothing is written and nothing mended. A file that is not as it should
    be is refused with file, row and column, exit code 2.

    Example: symolo measured my_robot/drive_1

    Example: symolo measured table-1
    """
    from diagnosis.importers.choose import read_measurement
    from diagnosis.measured.overview import overview
    from pipeline.diagnosing.importers import IMPORTERS

    for line in overview(read_measurement(case, IMPORTERS, as_)):
        typer.echo(line)
