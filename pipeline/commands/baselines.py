"""The command baselines: how well standard methods find the robot in a release."""

from math import radians
from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.options import checked_input, checked_new_folder, names


def baselines(
    folder: Annotated[
        Path,
        typer.Argument(metavar="DIR", callback=checked_input, help="A release, or what `symolo simulate` made."),
    ],
    *,
    out: Annotated[
        Path, typer.Option("--out", metavar="OUT", callback=checked_new_folder, help="Output folder: new or empty.")
    ],
    methods: Annotated[
        str | None,
        typer.Option(
            "--methods",
            metavar="NAMES",
            help="odometry, ekf, particles, pictures, with commas between them; by default all that can be used.",
        ),
    ] = None,
    runs: Annotated[
        str | None, typer.Option("--runs", metavar="GLOB", help="Only runs whose name matches, such as 'CW/*'.")
    ] = None,
    start_sd_cm: Annotated[
        float,
        typer.Option(min=0.01, max=100, metavar="CM", help="How far from where it believes the robot is put down."),
    ] = 0.1,
    start_sd_deg: Annotated[
        float, typer.Option(min=0.01, max=90, metavar="DEG", help="And how far turned; standard deviations.")
    ] = 0.1,
    seed: Annotated[int, typer.Option(min=0, max=2**63 - 1, help="Of the start's error and the particles.")] = 1,
) -> None:
    """Localise the robot by odometry, Kalman filter, particle filter and pictures; errors against the truth.

    The methods see readings, the map and the start, never the truth. Writes a table, its numbers, a figure and every
    estimate. The same release gives the same bytes.

    Example: symolo baselines data --out baselines --start-sd-cm 5 --start-sd-deg 5
    """
    import numpy as np

    from pipeline.baselines import METHODS
    from pipeline.baselines.compare import compare, methods_of, why_not
    from pipeline.baselines.runs import chosen, open_runs
    from pipeline.baselines.written import table, write
    from symolo.core.errors import InputError
    from symolo.core.new_folder import check_new
    from symolo.core.progress import report_here

    asked = METHODS if methods is None else methods_of(names(methods, "--methods"), "--methods")
    check_new(out, folder)
    everything = open_runs(folder)
    for method in asked if methods is not None else ():
        if why := why_not(method, everything):
            raise InputError(f"--methods {method.name}: {why}", where=str(folder))
    start_sd = np.array([start_sd_cm / 100, start_sd_cm / 100, radians(start_sd_deg)])
    wanted = chosen(everything, runs)
    compared = compare(asked, wanted, everything, start_sd=start_sd, seed=seed, report=report_here())
    write(compared, out)
    typer.echo(table(compared) + f"\n{out}")
