"""The random slip of a robot's wheels, from the headings of drives with known poses.

Between a logged heading and the one that the fitted robot predicts from its counts, the variance of the change over a
travel s is 2 c^2 + 2 q^2 s / b^2: c is the noise of a logged heading, b the track, and q the slip, the standard
deviation of each wheel's travel after 1 m (Chong and Kleeman, ICRA 1997). Windows of half a second show mostly the
noise. The changes from the start of a trial to each further metre show the slip, and with it whatever else differs
from trial to trial. q is the value at which their squares relative to this variance have the mean 1.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import exp, log, sqrt

import numpy as np

from diagnosis.diagnose import Diagnosis
from diagnosis.extended_robot import DIGITS, BesideFit
from diagnosis.measured.case_files.case_format import POSE
from diagnosis.measured.measurement import CaseKind
from diagnosis.measured.noise import trimmed_variance
from diagnosis.posterior.robot_numbers import RobotNumber, RobotNumbers
from diagnosis.predictors.pose.by_counts import WINDOW, Pose
from diagnosis.predictors.rows import good_values
from physics.effects.wheels_and_floor.random_slip import RandomSlip
from symolo.core.arrays import Array

MARK_M = 1.0
"""Distance between the places at which the heading is compared."""
MIN_GROUPS = 4
"""Smallest number of trials or sessions for a standard error."""
MIN_MARKS = 8
BISECTIONS = 50
MAX_SD = 0.5
"""Largest standard deviation of the logarithm of a slip; a less certain one is not known."""


@dataclass(frozen=True)
class RandomSlipEstimate:
    """Random slip of each wheel."""

    slip_m_sqrt_m: float
    sd_log: float
    """Standard deviation of its logarithm."""

    @property
    def effect(self) -> BesideFit:
        """The effect for the robot file, with the source of its numbers."""
        source = f"estimated from the headings of all drives; standard error {self.slip_m_sqrt_m * self.sd_log:.2g}"
        effect = RandomSlip(slip_m_sqrt_m=float(f"{self.slip_m_sqrt_m:.{DIGITS}g}"))
        return BesideFit(effect, {"slip_m_sqrt_m": source, "length_m": "the usual value; these data do not show it"})

    def beside(self, numbers: RobotNumbers) -> RobotNumbers:
        """Return the numbers of a fit and this one, which is independent of them."""
        name = "slip_m_sqrt_m"
        field = RandomSlip.parameters()[name]
        path, mean = ("effects", RandomSlip.name, name), log(self.slip_m_sqrt_m)
        number = RobotNumber(path, field.unit, is_log=True, mean=mean, low=field.low, high=field.high)
        count, rank = numbers.factor.shape
        factor = np.zeros((count + 1, count + 1))
        factor[:count, :rank], factor[count, count] = numbers.factor, self.sd_log
        return replace(numbers, numbers=(*numbers.numbers, number), factor=factor)


@dataclass(frozen=True)
class HeadingChanges:
    """Changes of the heading error of one trial."""

    group: str
    """Session of the trial, or its name."""
    short_rad: Array
    """(S,), over half a second."""
    short_m: Array
    """(S,), travels in them."""
    long_rad: Array
    """(L,), from the start of the trial to each metre."""
    long_m: Array
    """(L,), travels to there."""


def random_slip(diagnosis: Diagnosis) -> RandomSlipEstimate | None:
    """Return the random slip of the wheels that a log of drives shows.

    Returns:
        None if the log has no counts with known poses, or too few and too short drives, or if the noise of the
        headings hides the slip.
    """
    stage = next((stage for stage in diagnosis.evidence.stages if isinstance(stage, Pose)), None)
    if stage is None or diagnosis.measurement.kind is not CaseKind.DRIVE_LOG:
        return None
    return slip_of_headings(_changes(diagnosis, stage), diagnosis.fit.robot.drive.track_m)


def slip_of_headings(trials: Sequence[HeadingChanges], track_m: float) -> RandomSlipEstimate | None:
    """Return the random slip of the wheels of a robot with this track; None if the trials do not determine it."""
    groups = sorted({trial.group for trial in trials})
    if len(groups) < MIN_GROUPS or sum(len(trial.long_m) for trial in trials) < MIN_MARKS:
        return None
    whole = _slip(trials, track_m)
    left_out = [_slip([trial for trial in trials if trial.group != group], track_m) for group in groups]
    if whole == 0.0 or min(left_out) == 0.0:
        return None
    # The jackknife over groups of trials, which may share what differs from day to day.
    sd_log = sqrt(len(groups) - 1) * float(np.std(np.log(left_out)))
    return RandomSlipEstimate(whole, sd_log) if sd_log <= MAX_SD else None


def _changes(diagnosis: Diagnosis, stage: Pose) -> list[HeadingChanges]:
    measurement, robot = diagnosis.measurement, diagnosis.fit.robot
    logged = np.stack([good_values(measurement, name) for name in POSE], axis=-1)
    starts = np.cumsum([0, *stage.trials[:-1]])
    error_rad = logged[:, 2] - stage.path(robot, np.nan_to_num(logged[starts]))[:, 2]
    travel_m = stage.travel_m(robot)
    changes = []
    for trial, start in zip(measurement.trials, starts.tolist(), strict=True):
        rows = slice(start, start + len(trial.t_s))
        if np.isfinite(error_rad[rows]).any():
            since_start_m = np.cumsum(travel_m[rows]) - travel_m[start]
            changes.append(_changes_of(trial.session or trial.name, since_start_m, error_rad[rows]))
    return changes


def _changes_of(group: str, travel_m: Array, error_rad: Array) -> HeadingChanges:
    """Return the changes of one trial, from travels and heading errors in its rows (n,); errors may be NaN."""
    known = np.isfinite(error_rad)
    first = int(np.argmax(known))
    at_marks = np.searchsorted(travel_m, np.arange(travel_m[first] + MARK_M, travel_m[-1], MARK_M))
    at_marks = at_marks[known[at_marks]]
    short_rad, short_m = (values[WINDOW::WINDOW] - values[:-WINDOW:WINDOW] for values in (error_rad, travel_m))
    usable = np.isfinite(short_rad)
    return HeadingChanges(
        group=group,
        short_rad=short_rad[usable],
        short_m=short_m[usable],
        long_rad=error_rad[at_marks] - error_rad[first],
        long_m=travel_m[at_marks] - travel_m[first],
    )


def _slip(trials: Sequence[HeadingChanges], track_m: float) -> float:
    """Return the slip [m / sqrt(m)] by bisection; 0 if the noise of the headings alone explains the changes."""
    short_rad, short_m = (np.concatenate([getattr(t, name) for t in trials]) for name in ("short_rad", "short_m"))
    long_rad, long_m = (np.concatenate([getattr(t, name) for t in trials]) for name in ("long_rad", "long_m"))
    by_travel, short = 2.0 / track_m**2, trimmed_variance(short_rad)

    def excess(slip: float) -> float:
        noise = max(short - by_travel * slip**2 * float(np.mean(short_m)), 0.0)
        return float(np.mean(long_rad**2 / (noise + by_travel * slip**2 * long_m))) - 1.0

    field = RandomSlip.parameters()["slip_m_sqrt_m"]
    low, high = log(1e-6), log(field.high)
    if excess(exp(low)) <= 0.0:
        return 0.0
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if excess(exp(middle)) > 0.0 else (low, middle)
    return exp(0.5 * (low + high))
