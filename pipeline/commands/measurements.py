"""The command `symolo inspect`: what measured data contain, before they are used."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.options import checked_input


def inspect(
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
        typer.Option(
            "--importer", metavar="NAME", help="Kind of data; by default symolo recognises it from the files."
        ),
    ] = None,
) -> None:
    """Show what the log of a real robot or test bench contains: channels, rates, gaps, noise.

    CASE is one of these; symolo recognises the kind from the files:

    - a case folder: nominal.yaml and data.csv, kinds motor_steady,
      motor_step, tof_bench and drive_log (docs/measured.md)

    - a run folder or release of symolo, or a SyMoLo data.csv

    - a file or folder of OptiOdom, Algernon, Robotino or VL53L0X data

    - table-1, table-3 or table-4 of the paper

    The command prints the trials with their rates and gaps. Then it prints
    for each channel: the number of rows; how many are missing, have no
    target, are stale (an old value repeated) or are outliers (6 sigma off
    their neighbours, or off the known distance); the smallest and largest
    good value; the quantisation step; the noise estimated from the data,
    with its correlation from row to row or the number of repeats behind
    it; the noise that the source states.

    Nothing is written or changed. A bad file is refused with its name,
    row and column, and exit code 2.

    Example: symolo inspect my_robot/drive_1

    Example: symolo inspect table-1
    """
    from diagnosis.importers.choose import read_measurement
    from diagnosis.measured.overview import overview
    from pipeline.diagnosing.importers import IMPORTERS

    for line in overview(read_measurement(case, IMPORTERS, as_)):
        typer.echo(line)
