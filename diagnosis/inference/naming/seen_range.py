"""The range in which an effect was seen: where its law is an observation, and not an extrapolation.

A law that fits slow arcs may be wrong in fast ones. Every named effect therefore carries the range of each covariate
over the rows in which it matters. Held-out rows count as well, since no effect is named that they contradict. If a
condition is also a reading, such as the speed of a motor, its value is the prediction of the model with the effect: the
prediction of the nominal model may be far off, and a reading has noise.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.fitting.hypothesis import CandidateEffect
from diagnosis.inference.unexplained.adequacy import change_by
from diagnosis.measured.case_files.case_format import LONG_AFTER_S
from diagnosis.measured.channel import Mask
from diagnosis.predictors.base import CovariateShape, Observed
from diagnosis.predictors.wheels.turning_loads import TURNING
from symolo.core.arrays import Array

MATTERS = 0.1
"""Change of a prediction in sigmas from which an effect matters in a row."""
_NO_CONDITIONS = ("row", "previous_distance_m", "distance_step_m", "voltage_step_V", "session_time_s", TURNING)
"""Smooth covariates that are no condition of an effect."""


@dataclass(frozen=True)
class SeenRange:
    """Range of one covariate over the rows in which an effect matters."""

    covariate: str
    low: float
    high: float

    @property
    def text(self) -> str:
        return f"{self.covariate} from {self.low:.3g} to {self.high:.3g}"


def seen_ranges(
    evidence: Evidence, nominal: HypothesisFit, fit: HypothesisFit, effect: CandidateEffect
) -> tuple[SeenRange, ...]:
    """Return the range of each smooth covariate over the rows, fitted or held out, in which an effect matters.

    Args:
        evidence: The observations.
        nominal: The fit without effects.
        fit: The fit with the effect.
        effect: One of the effects of `fit`.
    """
    matters = rows_of(evidence, nominal, fit, effect)
    readings = predicted_readings(evidence, fit)
    ranges: dict[str, SeenRange] = {}
    for observed, place in zip(evidence.observed, evidence.places, strict=True):
        for name, values in conditions(observed, readings):
            inside = values[matters[place] & np.isfinite(values)]
            if not len(inside):
                continue
            low, high = float(inside.min()), float(inside.max())
            if name == "t_s" and low >= LONG_AFTER_S:  # rows that were counted, because no times were logged
                continue
            before = ranges.get(name, SeenRange(name, low, high))
            ranges[name] = SeenRange(name, min(low, before.low), max(high, before.high))
    return tuple(ranges.values())


def rows_of(evidence: Evidence, nominal: HypothesisFit, fit: HypothesisFit, effect: CandidateEffect) -> Mask:
    """Return in which rows (N,), fitted or held out, an effect of `fit` matters; `nominal` has no effects."""
    spread = np.abs(fit.spreads[fit.hypothesis.parameters(effect)]).max(axis=0)
    rows = evidence.fit | evidence.heldout
    change = change_by(evidence.with_rows(fit=rows), nominal, fit, effect)
    return (np.abs(change) > MATTERS) | (rows & (spread > 0.0))


def predicted_readings(evidence: Evidence, fit: HypothesisFit) -> dict[str, Array]:
    """Return the predictions (n,) of each observed quantity by a fit."""
    mean = evidence.as_measured().predicted([fit.robot]).moved(fit.local_change).mean[0]
    return {observed.name: mean[place] for observed, place in zip(evidence.observed, evidence.places, strict=True)}


def conditions(observed: Observed, readings: Mapping[str, Array]) -> Iterator[tuple[str, Array]]:
    """Yield the name and the values (n,) of each condition of an observed quantity.

    Args:
        observed: The quantity.
        readings: Predictions (n,) by the name of a reading. They replace those of the nominal model, which may be far
            from them.
    """
    for covariate in observed.covariates:
        is_number = covariate.shape is CovariateShape.SMOOTH and covariate.second is None
        if is_number and covariate.as_rate is not None:
            name, duration_s = covariate.as_rate
            yield name, covariate.values / duration_s
        elif is_number and covariate.name not in _NO_CONDITIONS:
            reading = readings.get(covariate.name, covariate.values)
            yield covariate.name, reading if len(reading) == len(covariate.values) else covariate.values
