"""The command `symolo baselines`: how well standard methods localise the robot of a release."""

from math import radians
from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.options import checked_input, checked_new_folder, names


def baselines(
    folder: Annotated[
        Path,
        typer.Argument(
            metavar="DIR", callback=checked_input, help="A release, or an output folder of `symolo simulate`."
        ),
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
            help="odometry, ekf, particles, pictures, with commas between them; by default all that the data allow.",
        ),
    ] = None,
    runs: Annotated[
        str | None, typer.Option("--runs", metavar="GLOB", help="Include only runs whose name matches, such as 'CW/*'.")
    ] = None,
    start_sd_cm: Annotated[
        float,
        typer.Option(min=0.01, max=100, metavar="CM", help="Standard deviation of the error of the start position."),
    ] = 0.1,
    start_sd_deg: Annotated[
        float,
        typer.Option(min=0.01, max=90, metavar="DEG", help="Standard deviation of the error of the start direction."),
    ] = 0.1,
    seed: Annotated[
        int, typer.Option(min=0, max=2**63 - 1, help="Seed for the error of the start and for the particles.")
    ] = 1,
) -> None:
    """Localise the robot with odometry, a Kalman filter, a particle filter and images, and measure the errors.

    The methods get the sensor readings, the map and the start, never the true pose. The output is a table, its numbers
    as JSON, a plot, and every estimate. The same release gives the same bytes.

    Example: symolo baselines data --out baselines --start-sd-cm 5 --start-sd-deg 5
    """
    import numpy as np

    from pipeline.baselines import METHODS
    from pipeline.baselines.compare import compare, methods_of, why_not
    from pipeline.baselines.runs import chosen, open_runs
    from pipeline.baselines.written import table, write
    from symolo.core.errors import InputError
    from symolo.core.files.new_folder import check_new
    from symolo.core.progress import report_here

    chosen_methods = METHODS if methods is None else methods_of(names(methods, "--methods"), "--methods")
    check_new(out, folder)
    everything = open_runs(folder)
    for method in chosen_methods if methods is not None else ():
        if why := why_not(method, everything):
            raise InputError(f"--methods {method.name}: {why}", where=str(folder))
    start_sd = np.array([start_sd_cm / 100, start_sd_cm / 100, radians(start_sd_deg)])
    compared = compare(
        chosen_methods, chosen(everything, runs), everything, start_sd=start_sd, seed=seed, report=report_here()
    )
    write(compared, out)
    typer.echo(table(compared) + f"\n{out}")
