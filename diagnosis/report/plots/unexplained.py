"""Plot of the structure in the residuals that no effect explains."""

from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure

from diagnosis.diagnose import Diagnosis
from diagnosis.inference.unexplained.adequacy import Structure
from diagnosis.measured.channel import Mask
from diagnosis.predictors.base import Covariate, Observed
from diagnosis.predictors.wheels.floor_loads import FRICTION
from diagnosis.report.plots.panels import label_below, residual_panel
from diagnosis.report.report_data import ReportData
from diagnosis.report.sentences.quantities import listed
from symolo.core.arrays import Array
from symolo.pages.plotting import PURPLE, png, set_margins

SIZE_IN = (7.2, 3.4)
MAP_SIZE_IN = (4.8, 3.8)


def unexplained_plot(data: ReportData, structure: Structure) -> bytes:
    """Return the residuals of the readings with the named effects, along the covariate of a structure, as PNG."""
    covariate, residuals, holdout = shown_residuals(data.diagnosis, structure)
    is_map = covariate.second is not None
    figure = Figure(figsize=MAP_SIZE_IN if is_map else SIZE_IN, layout="constrained" if is_map else None)
    direction = "\nin the direction of motion," if structure.what.startswith(FRICTION) else ""
    if not is_map:
        below_in = 0.31 + 0.19 * (label_below(covariate).count("\n") + 1)
        set_margins(figure, 1, left_in=0.92, bottom_in=below_in, top_in=0.5 if direction else 0.3)
    axes = figure.subplots()
    residual_panel(axes, covariate, residuals, holdout, PURPLE)
    if not is_map:
        axes.set_ylabel("measured - predicted [σ]")
    title = f"{listed(structure.quantities)}: residuals{direction} along {structure.covariate}"
    axes.set_title(title, fontsize="medium", y=1.0)
    return png(figure)


def shown_residuals(diagnosis: Diagnosis, structure: Structure) -> tuple[Covariate, Array, Mask]:
    """Return the covariate of a structure, with residuals (n,) in sigmas of its quantities and which are held out.

    They are without the random drift of a range sensor, and without a law that was discovered afterwards. Where the
    structure is friction, they are in the direction of motion, so that friction always makes them negative.
    """
    evidence = diagnosis.evidence.as_measured()
    quantities = [
        (observed, place)
        for observed, place in zip(evidence.observed, evidence.places, strict=True)
        if observed.name in structure.quantities
    ]
    fit = diagnosis.fit if diagnosis.law is None else diagnosis.law.without
    mean = evidence.predicted([fit.robot]).moved(fit.local_change).mean[0]
    z = np.where(evidence.fit | evidence.heldout, (evidence.values - mean) / evidence.sd, np.nan)
    if structure.what.startswith(FRICTION):
        z *= np.sign(mean)
    residuals = np.concatenate([z[place] for _, place in quantities])
    covariate = _joined([_covariate_of(observed, structure) for observed, _ in quantities])
    return covariate, residuals, np.concatenate([observed.holdout for observed, _ in quantities])


def _covariate_of(observed: Observed, structure: Structure) -> Covariate:
    """Return the covariate of a structure, for one of its quantities."""
    covariate = next(each for each in observed.covariates if each.name == structure.covariate)
    shared = next((each for each in observed.shared_functions if each.what == structure.what), None)
    if shared is None:
        return covariate
    x_m, y_m = shared.places.T
    return replace(covariate, values=x_m, second=y_m)


def _joined(covariates: list[Covariate]) -> Covariate:
    """Return one covariate with the values of several quantities, one after the other."""
    first, *others = covariates
    if not others:
        return first
    seconds = [covariate.second for covariate in covariates if covariate.second is not None]
    values = np.concatenate([covariate.values for covariate in covariates])
    return replace(first, values=values, second=np.concatenate(seconds) if seconds else None)
