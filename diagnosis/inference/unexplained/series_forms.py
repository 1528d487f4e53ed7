"""Forms of an error in a time series: of the input, of a wall, or of a number that drifts, whose cause is in no list.

A residual of a time series lasts for many rows, so that a curve of any shape would go through it by chance. But an
error of the input, or a nominal number that changes during the session, shows in all quantities of a stage at once, and
the model itself says how: by its response to the input, or to the number. Two or three effects of the list may imitate
that together, and then leave no structure. Like the forms of a bench (`forms`), these have few numbers: their size, and
for a dead zone of the voltage its width. In a drive, the effects that depend on the time are rivals enough of a number
that drifts.
"""

from collections.abc import Iterator

import numpy as np

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.unexplained.forms import Form
from diagnosis.predictors.base import SESSION_TIME
from symolo.core.arrays import Array


def series_forms(evidence: Evidence, fit: HypothesisFit) -> Iterator[tuple[int, Form, Array]]:
    """Yield the forms of the stages whose responses to errors of their input are known.

    Returns:
        The number of the quantity that each form changes most, the form, and its column (N,) in sigmas.
    """
    first = 0
    for stage in evidence.stages:
        quantities = range(first, first + len(stage.observed))
        first += len(stage.observed)
        if any(observed.input_errors for observed in stage.observed):
            yield from _input_errors(evidence, fit, quantities)
        if any(observed.numbers_may_drift for observed in stage.observed):
            yield from _drifting_numbers(evidence, fit, quantities)


def _input_errors(evidence: Evidence, fit: HypothesisFit, quantities: range) -> Iterator[tuple[int, Form, Array]]:
    for errors in zip(*(evidence.observed[k].input_errors for k in quantities), strict=True):
        change = np.zeros(len(fit.z))
        for k, error in zip(quantities, errors, strict=True):
            change[evidence.places[k]] = error.response
        first, column = errors[0], evidence.whitened(change) / fit.sd
        yield _stage_form(evidence, quantities, first.covariate, first.what, column, first.chosen)


def _drifting_numbers(evidence: Evidence, fit: HypothesisFit, quantities: range) -> Iterator[tuple[int, Form, Array]]:
    """Yield each nominal number as one that is right at the start of the session, or in its middle, and drifts."""
    session_s = np.full(len(fit.z), np.nan)
    for k in quantities:
        for covariate in evidence.observed[k].covariates:
            if covariate.name == SESSION_TIME:
                session_s[evidence.places[k]] = covariate.values
    is_of_stage = np.isfinite(session_s)
    inside = session_s[evidence.fit & is_of_stage]
    numbers = zip(fit.hypothesis.nuisances, fit.slopes, strict=False) if len(inside) else ()
    for nuisance, slope in ((nuisance, slope) for nuisance, slope in numbers if nuisance.change is None):
        for right_at in (float(inside.min()), float(inside.mean())):
            column = np.where(is_of_stage, slope * (session_s - right_at), 0.0)
            yield _stage_form(evidence, quantities, SESSION_TIME, f"{nuisance.name} that drifts", column)


def _stage_form(  # noqa: PLR0917 - a form, and the quantities that it changes
    evidence: Evidence, quantities: range, covariate: str, what: str, column: Array, chosen: int = 0
) -> tuple[int, Form, Array]:
    """Return a form of the quantity that it changes most."""
    squares = np.where(evidence.fit, evidence.weight * column**2, 0.0)
    largest = max(quantities, key=lambda k: float(squares[evidence.places[k]].sum()))
    rank = [each.name for each in evidence.observed[largest].covariates].index(covariate)
    return largest, Form(covariate, rank, what, chosen, column[evidence.places[largest]]), column
