"""Where the structure lives that no name accounts for."""

from matplotlib.figure import Figure

from diagnosis.inference.unexplained.adequacy import Structure
from diagnosis.report.findings import Findings
from diagnosis.report.plots.panels import residual_panel
from symolo.pages.plotting import PURPLE, png

SIZE_IN = (7.2, 3.4)


def unexplained_picture(found: Findings, structure: Structure) -> bytes:
    """What the model with the named effects leaves, along the covariate of a structure, as PNG."""
    diagnosis = found.diagnosis
    names = [of.name for of in diagnosis.evidence.observed]
    k = names.index(structure.observed)
    of, place = diagnosis.evidence.observed[k], diagnosis.evidence.places[k]
    covariate = next(c for c in of.covariates if c.name == structure.covariate)
    figure = Figure(figsize=SIZE_IN, layout="constrained")
    axes = figure.subplots()
    residual_panel(axes, covariate, found.z[2][place], of.holdout, PURPLE)
    if covariate.second is None:
        axes.set_ylabel("measured - predicted [σ]")
    axes.set_title(f"{of.name}: what is left along {structure.covariate}", fontsize="medium")
    return png(figure)
