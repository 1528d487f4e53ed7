"""Plot of one observed quantity: measured and predicted values, and the residuals of each model."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from diagnosis.inference.gain import trimmed_rms
from diagnosis.predictors.base import Covariate, Observed
from diagnosis.report.plots.panels import AFTER, BEFORE, CALIBRATED, MEASURED, label_below, reach_of, residual_panel
from diagnosis.report.report_data import ReportData
from diagnosis.report.sentences.quantities import axis
from symolo.core.arrays import Array
from symolo.pages.plotting import finished, png, set_margins

SIZE_IN = (3.1, 3.1)
"""Size of a panel."""
INPUTS = ("distance_m", "u_cmd_V")
"""Quantities that are swept on a bench."""


def misfit_plot(data: ReportData, k: int) -> bytes:
    """Return the plot of the k-th observed quantity as PNG."""
    evidence = data.diagnosis.evidence
    observed, place = evidence.observed[k], evidence.places[k]
    covariate = _covariate(data, observed)
    models = [("nominal", BEFORE, 0), ("nominal, fitted", CALIBRATED, 1)]
    if data.diagnosis.fitted_effects:
        models.append(("extended", AFTER, 2))
    panels = 1 + len(models)
    is_map = covariate is not None and covariate.second is not None
    figure = Figure(figsize=(SIZE_IN[0] * panels, SIZE_IN[1]), layout="constrained" if is_map else None)
    if not is_map:
        lines = 1 if covariate is None else label_below(covariate).count("\n") + 1
        set_margins(figure, panels, left_in=0.92, bottom_in=0.31 + 0.19 * lines, top_in=0.5, between_in=0.71)
    axes = figure.subplots(1, panels, squeeze=False)[0]
    last = models[-1]
    _values(axes[0], observed, [data.means[0][place], data.means[last[2]][place]], last, data.z[1][place])
    for panel, (name, colour, model) in zip(axes[1:], models, strict=True):
        z = data.z[model][place]
        if covariate is not None:
            # The fitted models share a scale, to be compared by eye; the nominal one may have far larger residuals.
            shared = None if model == 0 else reach_of(np.concatenate([data.z[m][place] for *_, m in models[1:]]))
            residual_panel(panel, covariate, z, observed.holdout, colour, shared)
        sizes = np.abs(z[np.isfinite(z)])
        error = trimmed_rms(sizes) if len(sizes) else float("nan")
        panel.set_title(f"{name}: {error:.3g} σ", fontsize="medium", y=1.0)
    if covariate is None or covariate.second is None:
        axes[1].set_ylabel("measured - predicted [σ]")
    return png(figure)


def _covariate(data: ReportData, observed: Observed) -> Covariate | None:
    """Return the covariate of the structure that is shown of a quantity, or else its first one."""
    for structure in data.structures:
        if structure.observed == observed.name:
            return next(c for c in observed.covariates if c.name == structure.covariate)
    return observed.covariates[0] if observed.covariates else None


def _values(axes: Axes, observed: Observed, means: list[Array], last: tuple[str, str, int], z: Array) -> None:
    """Draw measured and predicted values: along what a bench sweeps, or against time in the worst trial."""
    swept = next((c for name in INPUTS for c in observed.covariates if c.name == name), None)
    is_bench = swept is not None and not _is_log(observed)
    x = swept.values if is_bench and swept is not None else observed.t_s
    rows = np.isfinite(x) if is_bench else observed.trial == _worst(observed, z)
    shown = rows & observed.usable
    axes.plot(
        x[shown], observed.values[shown], ".", color=MEASURED, markersize=4 if is_bench else 2.5, label="measured"
    )
    line = "none" if is_bench else "-"
    for mean, name, colour, marker in zip(means, ("nominal", last[0]), (BEFORE, last[1]), ("x", "+"), strict=True):
        good = shown & np.isfinite(mean)
        axes.plot(
            x[good],
            mean[good],
            color=colour,
            linestyle=line,
            linewidth=1.0,
            marker=marker if is_bench else "",
            markersize=5,
            label=name,
        )
    title = observed.name if is_bench else f"{observed.name}, trial {_worst(observed, z) + 1}"
    along = axis(swept.name) if is_bench and swept is not None else "time [s]"
    finished(axes, title, along, axis(observed.name), beside=True)


def _is_log(observed: Observed) -> bool:
    """Return whether the rows are close in time, so that a voltage in them is a step and not a sweep."""
    steps = np.diff(observed.t_s)
    return bool(len(steps)) and float(np.median(steps)) < 0.2


def _worst(observed: Observed, z: Array) -> int:
    """Return the trial with the largest mean square of its residuals."""
    trials = np.unique(observed.trial)
    # Residuals are limited to 20 sigma, so that a single outlier does not decide.
    residuals = [np.clip(z[(observed.trial == trial) & np.isfinite(z)], -20.0, 20.0) for trial in trials]
    errors = [float(np.mean(trial_residuals**2)) if len(trial_residuals) else 0.0 for trial_residuals in residuals]
    return int(trials[int(np.argmax(errors))])
