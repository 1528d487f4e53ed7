"""Parameters of the nominal robot that the fit leaves far outside their tolerances, beside what is named."""

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

from diagnosis.diagnose import Diagnosis
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.fitting.hypothesis import deviated
from diagnosis.inference.selection.stepwise import MAX_EFFECTS
from diagnosis.report.sentences.quantities import with_error

CHANCE = 0.01
"""Probability that a robot within its tolerances, which are standard deviations, has such a parameter by chance."""


@dataclass(frozen=True)
class ParameterOff:
    """A parameter of the nominal robot that is wrong by more than its tolerance allows."""

    name: str
    unit: str
    """Unit; 1 for a number without one."""
    nominal: float
    tolerance: float
    fitted: float
    std: float
    """Standard error of the fitted value."""
    tolerances: float
    """Deviation in tolerances."""
    meaning: str
    """Meaning of a number that no nominal.yaml has; empty for the others."""

    def text(self, sign: str) -> str:
        """Return the fitted and the nominal value, such as `track_m is 0.1498 ± 0.0004 m, not 0.144 m (...)`."""
        unit = "" if self.unit == "1" else f" {self.unit}"
        name = f"{self.name}, {assumed(self.meaning)}," if self.meaning else self.name
        return (
            f"{name} is {with_error(self.fitted, self.std, sign)}{unit}, not {self.nominal:.4g}{unit} "
            f"({self.tolerances:+.1f} tolerances of {self.tolerance:.2g}{unit})"
        )


def assumed(meaning: str) -> str:
    """Return the meaning of a number that no nominal.yaml has, and where its tolerance comes from."""
    return f"{meaning} (no nominal.yaml has it; its tolerance is assumed)"


def furthest_by_chance(parameters: int) -> float:
    """Return the deviation in tolerances that one of so many parameters exceeds with the probability CHANCE."""
    return NormalDist().inv_cdf(1.0 - CHANCE / (2.0 * max(parameters, 1)))


def parameters_off(fit: HypothesisFit) -> tuple[ParameterOff, ...]:
    """Return the parameters of the robot whose fit lies further outside their tolerances than by chance.

    Errors of single sessions are no parameters of the robot.
    """
    errors = np.sqrt(np.diag(fit.covariance)).tolist()
    rows = [
        (nuisance, x, error)
        for nuisance, x, error in zip(fit.hypothesis.nuisances, fit.x.tolist(), errors, strict=False)
        if nuisance.change is None
    ]
    limit = furthest_by_chance(len(rows))
    off = []
    for nuisance, x, error in sorted(rows, key=lambda row: -abs(row[1])):
        if abs(x) > limit:
            fitted = deviated(nuisance, x)
            step = 0.5 * abs(deviated(nuisance, x + error) - deviated(nuisance, x - error))
            number = (nuisance.value, nuisance.tolerance, fitted, step, x)
            off.append(ParameterOff(nuisance.name, nuisance.unit, *map(float, number), meaning=nuisance.meaning))
    return tuple(off)


def off_sentences(diagnosis: Diagnosis, sign: str = "±") -> str:
    """Return which nominal numbers are wrong beside what is named, and why they have no name; empty if none is."""
    off = parameters_off(diagnosis.fit)
    if not off:
        return ""
    beside = ", beside what is named" if diagnosis.names else ""
    what = "A number" if len(off) == 1 else f"{len(off)} numbers"
    robot = "the nominal robot" if not all(each.meaning for each in off) else "the log"
    verb = "seems" if len(off) == 1 else "seem"
    listed = "; ".join(each.text(sign) for each in off)
    text = f"{what} of {robot} {verb} to be wrong by more than the tolerance{beside}: {listed}."
    return f"{text} {_why(diagnosis, len(off))}"


def _why(diagnosis: Diagnosis, count: int) -> str:
    it, has = ("it", "has") if count == 1 else ("they", "have")
    if diagnosis.unexplained is not None:
        return "What stays unexplained may be the cause."
    if len(diagnosis.named) >= MAX_EFFECTS:
        return f"At most {MAX_EFFECTS} effects are named, so that {it} {has} no name here."
    return f"No effect is named for {'it' if count == 1 else 'them'}, since none explains these data clearly better."


def in_json(off: Sequence[ParameterOff]) -> list[dict[str, object]]:
    """Return the parameters for answer.json."""
    return [
        {
            "name": each.name,
            "unit": each.unit,
            "nominal": each.nominal,
            "tolerance": each.tolerance,
            "fitted": each.fitted,
            "std": each.std,
            "tolerances": each.tolerances,
        }
        for each in off
    ]
