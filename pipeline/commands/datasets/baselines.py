"""Command that localises the robot with standard methods, and judges own estimates: baselines."""

from math import radians
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pipeline.commands.options import Json, NewFolder, Runs, Seed, checked_input, if_given, names
from symolo.core.errors import InputError
from symolo.evaluation.align import Align

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pipeline.baselines.base import Method
    from pipeline.baselines.runs import LoggedRun

NO_METHOD = "none"
"""Word for no method in --methods."""
IMPORTED = "the runs were imported, and their readings were not simulated"
"""Why methods cannot be used on such runs."""


def baselines(
    folder: Annotated[
        Path,
        typer.Argument(
            metavar="DIR", callback=checked_input, help="A release, or an output folder of `symolo simulate`."
        ),
    ],
    *,
    out: NewFolder,
    methods: Annotated[
        str | None,
        typer.Option(
            "--methods",
            metavar="NAMES",
            help="Some of odometry,ekf,particles,retrieval,learned,ekf_imu,lidar,stereo; by default all that the data "
            "allow. With --estimate also none.",
        ),
    ] = None,
    estimate: Annotated[
        list[str] | None,
        typer.Option(
            "--estimate",
            metavar="NAME=PATH",
            help="Also judge estimates of your own method NAME: a file of one run, or a folder with a file for each "
            "run, such as CW/test_1.csv; CSV tables, or .txt and .tum as of TUM. May be repeated.",
        ),
    ] = None,
    align: Annotated[
        Align,
        typer.Option(
            help="Alignment of own estimates with the true poses: none; se2, the turn and the shift with which their "
            "places agree best; start, of the first pose."
        ),
    ] = Align.NONE,
    max_gap_ms: Annotated[
        float,
        typer.Option(
            min=0,
            max=10_000,
            metavar="MS",
            help="Largest time between an own estimate and the row of data.csv with which it is compared.",
        ),
    ] = 10.0,
    model: Annotated[
        Path | None,
        typer.Option(
            "--model",
            metavar="MODEL",
            callback=if_given(checked_input),
            help="Model of `symolo train`, which the method `learned` needs.",
        ),
    ] = None,
    runs: Runs = None,
    start_sd_cm: Annotated[
        float,
        typer.Option(min=0.01, max=100, metavar="CM", help="Standard deviation of the error of the start position."),
    ] = 0.1,
    start_sd_deg: Annotated[
        float,
        typer.Option(min=0.01, max=90, metavar="DEG", help="Standard deviation of the error of the start direction."),
    ] = 0.1,
    slip_mm: Annotated[
        float,
        typer.Option(
            min=0.001,
            max=100,
            metavar="MM",
            help="Random error of the distance that a wheel rolls, after 1 m, which the methods assume. "
            "A diagnosis of drives prints that of the measured robot.",
        ),
    ] = 0.3,
    seed: Seed = 1,
    as_json: Json = False,
) -> None:
    """Localise the robot with standard methods, judge estimates of your own method, and measure the errors.

    The methods are odometry, a Kalman filter, a particle filter and images. They get the sensor readings, the map and
    the start pose, but not the true poses. Robots with an IMU, a lidar or a stereo pair have further methods. The
    command prints a table of the errors, and writes the table, all errors as JSON, a plot, and the estimates. The same
    release gives the same bytes.

    Example: symolo baselines data --out baselines --start-sd-cm 5 --start-sd-deg 5

    Example: symolo baselines data --out mine --methods odometry --estimate mine=estimates
    """
    from dataclasses import replace

    import numpy as np

    from pipeline.baselines import METHODS
    from pipeline.baselines.compare import BaselineComparison, compare
    from pipeline.baselines.output import table, write
    from pipeline.baselines.own_estimates import judge, own_estimates
    from pipeline.baselines.runs import chosen, is_imported, open_runs, open_true_runs
    from symolo.core.files.new_folder import check_new
    from symolo.core.progress import report_here

    own_methods = own_estimates(estimate or (), [method.name for method in METHODS])
    if methods == NO_METHOD and not own_methods:
        raise InputError("--methods", got=methods, cure="name methods, or judge your own with --estimate")
    check_new(out, folder)
    judged_runs = chosen(open_true_runs(folder), runs) if own_methods else ()
    judgement = judge(own_methods, judged_runs, align=align, max_gap_s=max_gap_ms / 1000)
    start_sd, slip_m = np.array([start_sd_cm / 100, start_sd_cm / 100, radians(start_sd_deg)]), slip_mm / 1000
    if own_methods and (methods == NO_METHOD or (methods is None and is_imported(folder))):
        left_out = {} if methods else dict.fromkeys((method.name for method in METHODS), IMPORTED)
        compared = BaselineComparison((), judged_runs, {}, left_out, start_sd, slip_m, seed)
    else:
        all_runs = open_runs(folder)
        localised = chosen(all_runs, runs)
        chosen_methods, warnings = _methods(methods, model, localised, all_runs, folder)
        compared = compare(
            chosen_methods,
            localised,
            all_runs,
            start_sd=start_sd,
            slip_m_sqrt_m=slip_m,
            seed=seed,
            report=report_here(),
        )
        compared = replace(compared, warnings=warnings)
    compared = compared.with_judgement(judgement)
    for warning in compared.warnings:
        typer.echo(f"warning: {warning}", err=True)
    write(compared, out)
    if as_json:
        from pipeline.json_results.baselines import BaselinesResult

        typer.echo(BaselinesResult.from_comparison(str(out), compared).to_json())
    else:
        typer.echo(table(compared) + f"\n{out}")


def _methods(
    text: str | None,
    model: Path | None,
    localised: "Sequence[LoggedRun]",
    all_runs: "Sequence[LoggedRun]",
    folder: Path,
) -> "tuple[tuple[Method, ...], tuple[str, ...]]":
    """Return the methods of --methods, and warnings about them."""
    from pipeline.baselines import METHODS
    from pipeline.baselines.compare import methods_of, why_not
    from pipeline.baselines.learned.method import overlap, with_model
    from pipeline.baselines.learned.model import read_model

    methods, warning = METHODS if text is None else methods_of(names(text, "--methods"), "--methods"), ""
    if model is not None:
        trained = read_model(model)
        methods = with_model(methods, trained, localised)
        warning = overlap(trained, localised)
    for method in methods if text is not None else ():
        if why := why_not(method, all_runs):
            raise InputError(f"--methods {method.name}: {why}", where=str(folder))
    return tuple(methods), (warning,) if warning else ()
