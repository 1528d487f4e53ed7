"""`symolo inspect`: shows what is in measured data before a diagnosis."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.options import ImporterName, Json, checked_input


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
    importer: ImporterName = None,
    as_json: Json = False,
) -> None:
    """Show what the log of a real robot or test bench contains: channels, rates, gaps, noise.

    CASE is one of the following; symolo recognises the kind from the files:

    - a case folder with nominal.yaml and data.csv, of the kind motor_steady,
      motor_step, tof_bench or drive_log (docs/measured.md)

    - a release of symolo, a run of it, or a SyMoLo data.csv

    - a file or folder of OptiOdom, Algernon, Robotino or VL53L0X data

    - table-1, table-3 or table-4 of the paper

    The command prints the trials with their rates and gaps. Then it prints
    for each channel:

    - the number of rows

    - how many rows are missing, have no target, are stale (repeat an old
      value) or are outliers (6 sigma from their neighbours, or from the
      known distance)

    - the smallest and largest good value, and the quantisation step

    - the noise estimated from the data, with its correlation from row to
      row or the number of repeated measurements

    - the noise that the source states

    The command writes no file. If a file is wrong, it prints the file name,
    row and column, and ends with exit code 2.

    Example: symolo inspect my_robot/drive_1

    Example: symolo inspect table-1
    """
    from diagnosis.importers.choose import read_measurement
    from diagnosis.measured.overview import overview, summarise
    from pipeline.diagnosing.importers import IMPORTERS

    measurement = read_measurement(case, IMPORTERS, importer)
    if as_json:
        from pipeline.json_results.inspect import InspectResult

        typer.echo(InspectResult.from_summary(summarise(measurement)).to_json())
        return
    for line in overview(measurement):
        typer.echo(line)
