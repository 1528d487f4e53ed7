"""Forms of an error in a time series: an error of the input, or a number that drifts, whose cause is in no list.

A residual of a time series lasts for many rows, so that a curve of any shape would go through it by chance. But an
error of the input, or a nominal number that changes during the session, shows in all quantities of a stage at once, and
the model itself says how: by its response to the input, or to the number. Two or three effects of the list may imitate
that together, and then leave no structure. Like the forms of a bench (`forms`), these have a single number, their size.
"""

from collections.abc import Iterator

import numpy as np

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.unexplained.forms import Form
from diagnosis.predictors.base import SESSION_TIME, Observed
from symolo.core.arrays import Array


def series_forms(evidence: Evidence, fit: HypothesisFit) -> Iterator[tuple[int, Form, Array]]:
    """Yield the forms beside a fit: the quantity that each changes most, the form, and its column (N,) in sigmas."""
    for number in range(len(evidence.stages)):
        quantities = [k for k, place in enumerate(evidence.places) if evidence.of_stage[place.start] == number]
        if all(evidence.observed[k].is_series for k in quantities):
            yield from _input_errors(evidence, fit, quantities)
            yield from _drifting_numbers(evidence, fit, quantities)


def _input_errors(evidence: Evidence, fit: HypothesisFit, quantities: list[int]) -> Iterator[tuple[int, Form, Array]]:
    several = [evidence.observed[k].input_errors for k in quantities]
    for errors in zip(*several, strict=True):
        column = np.zeros(len(fit.z))
        for k, error in zip(quantities, errors, strict=True):
            column[evidence.places[k]] = error.response / fit.sd[evidence.places[k]]
        yield _of_stage(evidence, quantities, errors[0].covariate, errors[0].what, column)


def _drifting_numbers(
    evidence: Evidence, fit: HypothesisFit, quantities: list[int]
) -> Iterator[tuple[int, Form, Array]]:
    """Yield each nominal number as one that is right at the start of the session, or in its middle, and drifts."""
    times = [_session_time_s(evidence.observed[k]) for k in quantities]
    session_s = np.zeros(len(fit.z))
    for k, time_s in zip(quantities, times, strict=True):
        if time_s is None:
            return
        session_s[evidence.places[k]] = time_s
    of_stage = np.isin(evidence.quantity, quantities)
    inside = session_s[evidence.fit & of_stage]
    if not len(inside):
        return
    numbers = zip(fit.hypothesis.nuisances, fit.slopes, strict=False)
    for nuisance, slope in ((nuisance, slope) for nuisance, slope in numbers if nuisance.change is None):
        for right_at in (float(inside.min()), float(inside.mean())):
            column = np.where(of_stage, slope * (session_s - right_at), 0.0)
            what = f"{nuisance.name} that drifts"
            yield _of_stage(evidence, quantities, SESSION_TIME, what, column)


def _of_stage(
    evidence: Evidence, quantities: list[int], covariate: str, what: str, column: Array
) -> tuple[int, Form, Array]:
    """Return a form of the quantity that it changes most."""
    squares = np.where(evidence.fit, evidence.weight * column**2, 0.0)
    most = max(quantities, key=lambda k: float(squares[evidence.places[k]].sum()))
    names = [each.name for each in evidence.observed[most].covariates]
    rank = names.index(covariate) if covariate in names else len(names)
    return most, Form(covariate, rank, what, 0, column[evidence.places[most]]), column


def _session_time_s(quantity: Observed) -> Array | None:
    return next((each.values for each in quantity.covariates if each.name == SESSION_TIME), None)
