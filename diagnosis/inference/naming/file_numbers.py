"""The numbers that the file of an effect states with standard errors, beside those that were fitted.

The file of a discovered law claims numbers. Another measurement confirms the law only if its numbers agree with them: a
form with other numbers, or the other sign, is another law.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from math import hypot, inf, isfinite, pi, remainder, sqrt

from configs.effects.base import Effect
from configs.effects.parameter import Parameter
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit, fits
from diagnosis.inference.fitting.hypothesis import CandidateEffect

MAX_APART = 3.0
"""Largest difference of two numbers that agree, in combined standard errors."""


@dataclass(frozen=True)
class FileNumber:
    """One number of an effect as its file states it, beside the fitted one."""

    name: str
    value: float
    std: float
    apart: float
    """Difference of the fitted number in combined standard errors."""


def file_numbers(
    evidence: Evidence, fit: HypothesisFit, effect: CandidateEffect, std: Mapping[str, float]
) -> tuple[FileNumber, ...]:
    """Return the numbers that the file of an effect states with a standard error; none for any other effect.

    Args:
        evidence: The observations.
        fit: A fit with the effect.
        effect: The effect.
        std: Standard errors of the fit by number.
    """
    values = _turned_like_the_file(effect.kind, fit.hypothesis.values(effect, fit.x))
    numbers = []
    for name, number, stated_std in _stated(effect):
        difference, error = abs(_difference(number, values[name])), std[name]
        if difference > 0.0 and not isfinite(error):
            # The cost does not change with the place of a jump until it meets the next row, and then it leaps.
            rise = _cost_at(evidence, fit, effect, {name: number.start}) - fit.cost
            error = difference / sqrt(rise) if rise > 0.0 else inf
        apart = 0.0 if difference == 0.0 else difference / hypot(stated_std, error)
        numbers.append(FileNumber(name, number.start, stated_std, apart))
    return tuple(numbers)


def _stated(effect: CandidateEffect) -> Iterator[tuple[str, Parameter, float]]:
    """Yield name, number and stated standard error of each fitted number whose file states one."""
    numbers = effect.kind.parameters()
    for coordinate in effect.coordinates:
        number = numbers[coordinate.name]
        if number.std is not None:
            yield coordinate.name, number, number.std


def _difference(number: Parameter, value: float) -> float:
    difference = value - number.start
    return remainder(difference, 2.0 * pi) if number.is_angle else difference


def _turned_like_the_file(kind: type[Effect], values: Mapping[str, float]) -> Mapping[str, float]:
    """Return the values of a wave with the sign of the file: the other sign is the same wave half a turn further."""
    numbers = kind.parameters()
    angles = [name for name, number in numbers.items() if number.is_angle and name in values]
    sizes = [name for name, number in numbers.items() if number.null == 0.0 and name in values]
    if len(angles) != 1 or len(sizes) != 1 or values[sizes[0]] * numbers[sizes[0]].start >= 0.0:
        return values
    return {**values, sizes[0]: -values[sizes[0]], angles[0]: values[angles[0]] + pi}


def agree(numbers: Iterable[FileNumber]) -> bool:
    """Return whether all fitted numbers agree with those of the file."""
    return all(number.apart <= MAX_APART for number in numbers)


def cost_with_file_numbers(evidence: Evidence, fit: HypothesisFit, effect: CandidateEffect) -> float:
    """Return the cost with an effect of the fit held at the numbers of its file, and with everything else fitted."""
    return _cost_at(evidence, fit, effect, {name: number.start for name, number, _ in _stated(effect)})


def _cost_at(evidence: Evidence, fit: HypothesisFit, effect: CandidateEffect, values: Mapping[str, float]) -> float:
    """Return the cost with some numbers of an effect held at given values, and with everything else fitted."""
    hypothesis, x = fit.hypothesis, fit.x.copy()
    for place, coordinate in enumerate(effect.coordinates, fit.hypothesis.parameters(effect).start):
        if coordinate.name in values:
            x[place] = coordinate.coordinate(values[coordinate.name])
            hypothesis = hypothesis.with_fixed(place, float(x[place]))
    (held,) = fits(evidence, [(hypothesis, x)])
    return held.cost
