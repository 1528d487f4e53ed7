"""Of one observed quantity: what was measured and predicted, and what each model leaves."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from diagnosis.measured.channel import Mask
from diagnosis.predictors.base import Covariate, Observed
from diagnosis.report.findings import Findings
from diagnosis.report.plots.panels import AFTER, BEFORE, CALIBRATED, MEASURED, reach_of, residual_panel, trimmed_rms
from diagnosis.report.quantities import axis
from symolo.core.arrays import Array
from symolo.pages.plotting import finished, png

SIZE_IN = (3.1, 3.1)
"""Of a panel."""
INPUTS = ("distance_m", "u_cmd_V")
"""Along which a bench is swept."""


def misfit_picture(found: Findings, k: int) -> bytes:
    """Of the k-th observed quantity, as PNG."""
    evidence = found.diagnosis.evidence
    of, place = evidence.observed[k], evidence.places[k]
    covariate = _telling(found, of)
    models = [("nominal", BEFORE, 0), ("nominal, fitted", CALIBRATED, 1)]
    if found.diagnosis.named:
        models.append(("extended", AFTER, 2))
    panels = 1 + len(models)
    is_map = covariate is not None and covariate.second is not None
    figure = Figure(figsize=(SIZE_IN[0] * panels, SIZE_IN[1]), layout="constrained" if is_map else None)
    if not is_map:  # the layout engine takes as long as all the drawing
        width = SIZE_IN[0] * panels
        figure.subplots_adjust(left=0.92 / width, right=1.0 - 0.1 / width, bottom=0.16, top=0.84, wspace=0.31)
    axes = figure.subplots(1, panels, squeeze=False)[0]
    last = models[-1]
    _values(axes[0], of, [found.means[0][place], found.means[last[2]][place]], last, found.z[1][place])
    for panel, (name, colour, model) in zip(axes[1:], models, strict=True):
        z = found.z[model][place]
        if covariate is not None:
            # The two that are fitted are to be compared by eye; the nominal one may be far above both.
            shared = None if model == 0 else reach_of(np.concatenate([found.z[m][place] for *_, m in models[1:]]))
            residual_panel(panel, covariate, z, of.holdout, colour, shared)
        panel.set_title(f"{name}: {trimmed_rms(z):.3g} σ", fontsize="medium")
    if covariate is None or covariate.second is None:
        axes[1].set_ylabel("measured - predicted [σ]")
    return png(figure)


def _telling(found: Findings, of: Observed) -> Covariate | None:
    """The covariate along which the fitted nominal robot's residual shows most."""
    for structure in found.before:
        if structure.observed == of.name:
            return next(c for c in of.covariates if c.name == structure.covariate)
    return of.covariates[0] if of.covariates else None


def _values(axes: Axes, of: Observed, means: list[Array], last: tuple[str, str, int], z: Array) -> None:
    """Measured and predicted: along what a bench sweeps, or against time in the trial that shows most."""
    swept = next((c for name in INPUTS for c in of.covariates if c.name == name), None)
    is_bench = swept is not None and not _is_log(of)
    x = swept.values if is_bench and swept is not None else of.t_s
    rows = np.isfinite(x) if is_bench else of.trial == _worst(of, z)
    shown = rows & of.usable
    axes.plot(x[shown], of.values[shown], ".", color=MEASURED, markersize=4 if is_bench else 2.5, label="measured")
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
    title = of.name if is_bench else f"{of.name}, trial {_worst(of, z) + 1}"
    along = axis(swept.name) if is_bench and swept is not None else "time [s]"
    finished(axes, title, along, axis(of.name), beside=True)


def _is_log(of: Observed) -> bool:
    """Whether rows are close in time: voltages of steps are no sweep."""
    steps = np.diff(of.t_s)
    return bool(len(steps)) and float(np.median(steps)) < 0.2


def _worst(of: Observed, z: Array) -> int:
    """The trial whose residuals are largest."""
    trials = np.unique(of.trial)
    errors = [_mean_square(z[of.trial == trial]) for trial in trials]
    return int(trials[int(np.argmax(errors))])


def _mean_square(z: Array) -> float:
    known: Mask = np.isfinite(z)
    return float(np.mean(np.clip(z[known], -20.0, 20.0) ** 2)) if known.any() else 0.0
