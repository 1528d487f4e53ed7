"""Plot of the structure in the residuals that no effect explains."""

import numpy as np
from matplotlib.figure import Figure

from diagnosis.inference.unexplained.adequacy import Structure
from diagnosis.report.plots.panels import residual_panel
from diagnosis.report.report_data import ReportData
from symolo.pages.plotting import PURPLE, png

SIZE_IN = (7.2, 3.4)


def unexplained_plot(data: ReportData, structure: Structure) -> bytes:
    """Return the residuals of the readings with the named effects, along the covariate of a structure, as PNG.

    They are without the random drift of a range sensor, and without a law that was discovered afterwards.
    """
    evidence = data.diagnosis.evidence.as_measured()
    k = [observed.name for observed in evidence.observed].index(structure.observed)
    observed, place = evidence.observed[k], evidence.places[k]
    covariate = next(c for c in observed.covariates if c.name == structure.covariate)
    fit = data.diagnosis.fit if data.diagnosis.law is None else data.diagnosis.law.without
    mean = evidence.predicted([fit.robot]).moved(fit.local_change).mean[0]
    usable = evidence.fit | evidence.heldout
    z = np.where(usable, (evidence.values - mean) / evidence.sd, np.nan)
    figure = Figure(figsize=SIZE_IN, layout="constrained")
    axes = figure.subplots()
    residual_panel(axes, covariate, z[place], observed.holdout, PURPLE)
    if covariate.second is None:
        axes.set_ylabel("measured - predicted [σ]")
    axes.set_title(f"{observed.name}: residuals along {structure.covariate}", fontsize="medium")
    return png(figure)
