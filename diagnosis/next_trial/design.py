"""The best trial within limits: it distinguishes the remaining models, and then narrows their parameters."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.diagnose import Diagnosis
from diagnosis.measured.measurement import CaseKind, Measurement
from diagnosis.next_trial.exchange import Criterion, best_units
from diagnosis.next_trial.expectation import Expectation, expectation
from diagnosis.next_trial.library import LIBRARIES
from diagnosis.next_trial.library.base import Units
from diagnosis.next_trial.library.drive_log import beyond_m, expected_paths
from diagnosis.next_trial.limits import Limits
from diagnosis.next_trial.models import predicted_units, robots_of
from diagnosis.next_trial.remaining import RemainingModel, remaining_models
from diagnosis.next_trial.separation import Sums, UnitStatistics
from diagnosis.next_trial.template import floor_of, nominal_drive, reachable_m_s, template_of
from diagnosis.predictors.base import Observed
from symolo.core.arrays import Array
from symolo.core.progress import plural

ENOUGH = 9.0
"""Separation in standard deviations from which a larger one is not needed."""
OTHERS = 0.25
"""Weight of the mean separation beside the smallest one: two models that no trial can distinguish must not keep it from
telling them from a third."""
PRECISION = 0.02
"""Weight of the precision of the parameters beside a separation: it decides between trials that separate alike."""
ORDERED = 0.02
"""Share of the criterion that an order of the rows that is easy to do may cost."""
WEAK = 3.0
"""Separation in standard deviations below which two models are not distinguished."""
MAX_PLANS = 4
"""Number of times that a drive is planned, on smaller floors, until the robot stays on the floor."""
UNIT = {
    CaseKind.MOTOR_STEADY: "row",
    CaseKind.TOF_BENCH: "row",
    CaseKind.MOTOR_STEP: "run",
    CaseKind.DRIVE_LOG: "manoeuvre",
}
"""What a trial of each kind consists of."""
RELAXED = 2.0
"""Factor on a limit by which it is tried whether this limit hinders."""

Say = Callable[[str], None]
"""Receiver of a line about the progress."""


@dataclass(frozen=True)
class RelaxedLimit:
    """A limit, and the smallest separation with a wider one."""

    text: str
    """Description of the limit and of its new value, such as `30 s instead of 15 s`."""
    smallest: float


@dataclass(frozen=True, eq=False)
class TrialDesign:
    """A trial and what is expected of it."""

    diagnosis: Diagnosis
    models: tuple[RemainingModel, ...]
    limits: Limits
    trial: Measurement
    """The trial without readings."""
    titles: tuple[str, ...]
    """Description of each run of the trial, or of each manoeuvre of a drive; empty for the rows of a bench."""
    observed: tuple[Observed, ...]
    """Quantities that the stages of the trial predict."""
    means: Array
    """(models, N), readings as each model predicts them, in the order of the observed quantities."""
    expected: Expectation
    hindrances: tuple[RelaxedLimit, ...]
    """Wider limits, the most helpful first, if the trial does not distinguish all models; else empty."""

    @property
    def ends(self) -> Sequence[int]:
        """Ends of the samples of each observed quantity in `means`."""
        return np.cumsum([len(observed.values) for observed in self.observed]).tolist()


def _quiet(_text: str) -> None:
    """Say nothing."""


def design_trial(diagnosis: Diagnosis, limits: Limits, say: Say = _quiet) -> TrialDesign:
    """Return the best trial within limits.

    Args:
        diagnosis: The diagnosis of the old data.
        limits: Limits of the trial.
        say: Called with a line before each part of the work.

    Raises:
        InputError: There is nothing to distinguish, or no trial can be designed for such data.
    """
    template = template_of(diagnosis.measurement)
    models = remaining_models(diagnosis)
    say(f"{plural(len(models), 'explanation')} of the old data left: {'; '.join(model.name for model in models)}")
    trial, titles = _best(diagnosis, models, template, limits, say)
    units = predicted_units(diagnosis, models, trial)
    expected = expectation(models, units)
    means = units.evidence.predicted(robots_of(models)).mean
    smallest = expected.smallest
    hindrances: list[RelaxedLimit] = []
    if smallest is not None and smallest.separation < WEAK:
        for text, wider in _relaxed(template, limits):
            say(f"these limits do not distinguish all explanations; with {text}:")
            longer, _ = _best(diagnosis, models, template, wider, say)
            other = expectation(models, predicted_units(diagnosis, models, longer)).smallest
            if other is not None:
                hindrances.append(RelaxedLimit(text, other.separation))
        hindrances.sort(key=lambda each: -each.smallest)
    observed = units.evidence.observed
    return TrialDesign(diagnosis, models, limits, trial, titles, observed, means, expected, tuple(hindrances))


def _best(
    diagnosis: Diagnosis, models: tuple[RemainingModel, ...], template: Measurement, limits: Limits, say: Say
) -> tuple[Measurement, tuple[str, ...]]:
    """Return the best trial within limits, without readings, and the descriptions of its runs.

    A robot with one of the effects leaves the planned path of a drive. Where it would come too near to the border, the
    drive is planned again on a floor that is smaller by that much.

    Raises:
        InputError: No trial can be designed within the limits.
    """
    best = _planned(diagnosis, models, template, limits, say)
    for _ in range(MAX_PLANS - 1 if template.kind is CaseKind.DRIVE_LOG else 0):
        paths = expected_paths(best[0], limits, diagnosis.nominal, robots_of(models))
        if (beyond := beyond_m(template, limits, paths)) <= 0.0:
            break
        limits = replace(limits, drift_m=limits.drift_m + beyond)
        say(f"the robot would come {1000.0 * beyond:.0f} mm too near to the border; the drive is planned again")
        best = _planned(diagnosis, models, template, limits, say)
    return best


def _planned(
    diagnosis: Diagnosis, models: tuple[RemainingModel, ...], template: Measurement, limits: Limits, say: Say
) -> tuple[Measurement, tuple[str, ...]]:
    """Return the best trial within limits, without readings, and the descriptions of its runs."""
    library = LIBRARIES[template.kind](template, limits, robots_of(models))
    settings = len(np.unique(library.setting))
    say(f"{plural(settings, f'different {UNIT[template.kind]}')}: each explanation predicts them, and the best remain")
    statistics = predicted_units(diagnosis, models, library.measurement).statistics(library)
    criterion = criterion_of(statistics)
    units = best_units(statistics, library.slots, library.setting, criterion)
    easy = library.ordered(units)
    best, other = (_value(statistics, criterion, each) for each in (units, easy))
    chosen = easy if other >= best - ORDERED * abs(best) else units
    return library.composed(chosen), tuple(library.titles[unit] for unit in chosen.tolist() if library.titles)


def criterion_of(statistics: UnitStatistics) -> Criterion:
    """Return the criterion: the smallest separation of each model from its rivals, as a mean by weight, and precision.

    A separation counts up to ENOUGH, so that no pair is neglected for another one that is far apart already.
    """
    weights = np.array([model.weight for model in statistics.models])

    def value(sums: Sums) -> Array:
        precision = PRECISION * statistics.precision(sums)
        if len(weights) == 1:
            return precision
        separations = np.minimum(statistics.separations(sums), ENOUGH)
        return statistics.smallest(separations) @ weights + OTHERS * separations.mean(axis=-1) + precision

    return value


def _value(statistics: UnitStatistics, criterion: Criterion, units: Units) -> float:
    return float(criterion(statistics.of_units.for_units(units).total()))


def _relaxed(template: Measurement, limits: Limits) -> Iterator[tuple[str, Limits]]:
    """Yield wider limits with a text each."""
    seconds = RELAXED * limits.seconds
    yield f"{seconds:g} s instead of {limits.seconds:g} s", replace(limits, seconds=seconds)
    if template.kind is CaseKind.DRIVE_LOG:
        yield from _relaxed_drive(template, limits)
        return
    if template.kind is CaseKind.TOF_BENCH:
        near_m, far_m = limits.distances_m
        wider = (near_m / RELAXED, far_m * RELAXED)
        text = f"distances from {wider[0]:.3g} to {wider[1]:.3g} m"
        yield text, replace(limits, distances_m=wider)
        return
    voltage_V = RELAXED * limits.max_voltage_V
    text = f"{voltage_V:g} V instead of {limits.max_voltage_V:g} V"
    yield text, replace(limits, max_voltage_V=voltage_V)
    if limits.one_direction:
        yield "both directions", replace(limits, one_direction=False)


def _relaxed_drive(template: Measurement, limits: Limits) -> Iterator[tuple[str, Limits]]:
    """Yield wider limits of a drive; the floor stays within the room, and the speed within that of the motors."""
    speed_m_s = min(RELAXED * limits.max_speed_m_s, reachable_m_s(template))
    if speed_m_s > limits.max_speed_m_s:
        text = f"{speed_m_s:.3g} m/s instead of {limits.max_speed_m_s:.3g} m/s"
        yield text, replace(limits, max_speed_m_s=speed_m_s)
    widest = floor_of(template)[1] if nominal_drive(template).world is not None else (np.inf, np.inf)
    wider = (min(RELAXED * limits.floor_m[0], widest[0]), min(RELAXED * limits.floor_m[1], widest[1]))
    if wider != limits.floor_m:
        yield "a floor of {:.3g} m x {:.3g} m".format(*wider), replace(limits, floor_m=wider)
