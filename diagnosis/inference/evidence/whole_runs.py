"""The numbers of a drive fitted to whole runs: what adds up along the way says most of itself at the end.

Windows of half a second tell which link of the chain is wrong. But a wheel that is a thousandth too large lies far
below the noise of a window, and a robust loss takes the skewness of that noise for a shift; over a run the same error
adds up to many times what the camera scatters. So the poses of each run are predicted from its first one and the counts
alone, as calibrations by whole paths do (Borenstein and Feng, IEEE Trans. Robotics and Automation 12 (1996) 869-880;
Sousa et al., J. Intell. Robot. Syst. 105:39 (2022)), and held against the log at PARTS points of it.

Errors at points of one run are one story: together they count as one place and one heading. How far a run strays beside
the model nobody knows beforehand, so that the cost is minus twice the likelihood with that scatter profiled out: n log
of the mean square, n two for each run's places and one for its headings, and the priors of the nominal parameters.
Effects enter by the rule of `selection`: that with the greatest fall of the cost, if the fall would name it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.inference.hypothesis import CandidateEffect, Hypothesis, moved
from diagnosis.inference.selection import MOST, needed
from diagnosis.measured.measurement import Measurement
from diagnosis.predictors.drive_log import POSE
from diagnosis.predictors.pose import Pose, seen_from_body
from diagnosis.predictors.rows import given
from symolo.core.arrays import Array

PARTS = 20
"""Points of a run, evenly spaced; its end is the last of them."""
FEWEST_RUNS = 4
"""From which a scatter can be found beside what is fitted."""
STEPS = 12
STEP = 1e-3
"""Of a derivative, in coordinates."""
SETTLED = 1e-3
"""Change of every coordinate at which a fit ends."""
LEAST = 1e-6
"""Scatter [m, rad] below which nothing is sure."""
INTO = 0.1
"""Of the way from no effect to its start value, where a fit begins: at a bound nothing has a slope."""


class WholeRuns:
    """All trials of a drive with counts and poses, each predicted from its first logged pose on."""

    def __init__(self, measurement: Measurement, nominal: RobotConfig) -> None:
        self._pose = Pose(measurement, nominal)
        log = np.stack([given(measurement, name) for name in POSE], axis=-1)
        rows, self._points = 0, []
        firsts = []
        for trial in measurement.trials:
            complete = rows + np.flatnonzero(np.isfinite(log[rows : rows + len(trial.t_s)]).all(axis=-1))
            if len(complete) < PARTS + 1 or complete[0] != rows:
                raise ValueError(f"trial {trial.name}: whole runs need a pose in the first row and {PARTS} after it")
            firsts.append(rows)
            self._points.append(complete[np.linspace(0, len(complete) - 1, PARTS + 1).round().astype(int)[1:]])
            rows += len(trial.t_s)
        self.count = len(firsts)
        self._starts = log[firsts]
        self._measured = log[np.stack(self._points)]

    def errors(self, robot: RobotConfig) -> Array:
        """(runs, PARTS, 3): place [m], along and across the heading at the start, and heading [rad]; robot less log."""
        path = self._pose.path(robot, self._starts)
        return seen_from_body(self._starts[:, None, 2], path[np.stack(self._points)] - self._measured)

    def free_of_start(self, errors: Array) -> Array:
        """Errors (..., runs, PARTS, 3) less what a wrong heading at the start makes of the places, run by run.

        A single camera frame says that heading, and a body that is tracked may stand askew on the robot: both turn the
        whole path about its start and say nothing of the wheels.
        """
        way = seen_from_body(self._starts[:, None, 2], self._measured - self._starts[:, None, :])[..., :2]
        across = np.stack([-way[..., 1], way[..., 0]], axis=-1)
        angle = (across * errors[..., :2]).sum(axis=(-1, -2)) / np.maximum((way**2).sum(axis=(-1, -2)), LEAST**2)
        found = errors.copy()
        found[..., :2] -= angle[..., None, None] * across
        return found


@dataclass(frozen=True)
class WholeRunFit:
    hypothesis: Hypothesis
    x: Array
    """(P,), coordinates."""
    covariance: Array
    """(P, P), of the coordinates."""
    cost: float
    place_m: float
    """Root mean square of what is left of a place, along one axis."""
    heading_rad: float

    @property
    def robot(self) -> RobotConfig:
        return self.hypothesis.robot(self.x)

    def std(self, effect: CandidateEffect) -> dict[str, float]:
        """Standard errors of an effect's numbers, in their units."""
        places = self.hypothesis.parameters(effect)
        errors = np.sqrt(np.diag(self.covariance)[places]).tolist()
        at = self.x[places].tolist()
        return {c.name: abs(c.slope(v)) * e for c, v, e in zip(effect.coordinates, at, errors, strict=True)}


def fitted_to_whole_runs(
    measurement: Measurement, hypothesis: Hypothesis, x: Array, effects: Sequence[CandidateEffect]
) -> WholeRunFit | None:
    """A hypothesis with its numbers fitted to the runs that are not held out, and the effects that those ask for.

    Args:
        measurement: A drive with counts and poses.
        hypothesis: What is known already; its effects stay.
        x: (P,), its coordinates, to begin at.
        effects: That may enter.

    Returns:
        None with fewer than four such runs.
    """
    trials = tuple(trial for trial in measurement.trials if not trial.holdout.any() and len(trial.t_s) > PARTS)
    if len(trials) < FEWEST_RUNS:
        return None
    runs = WholeRuns(replace(measurement, trials=trials), hypothesis.nominal)
    fit = _fit(runs, hypothesis, x)
    while len(fit.hypothesis.effects) < MOST:
        names = {effect.kind.name for effect in fit.hypothesis.effects}
        tried = []
        for effect in (e for e in effects if e.kind.name not in names):
            having = fit.hypothesis.with_effect(effect)
            tried.append((effect, _fit(runs, having, moved(fit.x, fit.hypothesis, having))))
        believed = [(e, of) for e, of in tried if fit.cost - of.cost > needed(e)]
        if not believed:
            break
        fit = min(believed, key=lambda both: both[1].cost + 3.0 * len(both[0].coordinates))[1]
    return fit


def _fit(runs: WholeRuns, hypothesis: Hypothesis, x: Array) -> WholeRunFit:
    """By Gauss-Newton steps, the scatter found anew at each; paths are nearly straight in such small numbers."""
    low, high = (np.array([getattr(c, end) for c in hypothesis.coordinates]) for end in ("low", "high"))
    x = _begun(hypothesis, x)
    priors = np.arange(len(x)) < len(hypothesis.nuisances)
    information = np.diag(priors.astype(float))
    for _ in range(STEPS):
        around = np.concatenate([x[None], x + STEP * np.eye(len(x))])
        errors = runs.free_of_start(np.stack([runs.errors(robot) for robot in hypothesis.robots(around)]))
        weight = 1.0 / (_scatter(errors[0]) * np.sqrt(PARTS))
        z = (errors[0] * weight).ravel()
        slopes = ((errors[1:] - errors[0]) * weight / STEP).reshape(len(x), -1)
        information = slopes @ slopes.T + np.diag(priors.astype(float))
        downhill = -slopes @ z - np.where(priors, x, 0.0)
        free = (np.diag(information) > 0.0) & ~(((x <= low) & (downhill < 0.0)) | ((x >= high) & (downhill > 0.0)))
        step = np.zeros(len(x))
        step[free] = np.linalg.lstsq(information[np.ix_(free, free)], downhill[free], rcond=1e-12)[0]
        x = np.clip(x + step, low, high)
        if np.max(np.abs(step), initial=0.0) < SETTLED:
            break
    scatter = _scatter(runs.free_of_start(runs.errors(hypothesis.robot(x))))
    cost = runs.count * float(np.log(scatter**2).sum()) + float((hypothesis.prior(x) ** 2).sum())
    covariance = np.linalg.pinv(information, rcond=1e-12, hermitian=True)
    return WholeRunFit(hypothesis, x, covariance, cost, float(scatter[0]), float(scatter[2]))


def _begun(hypothesis: Hypothesis, x: Array) -> Array:
    """Coordinates (P,) with those of an effect that is not there yet moved off its null."""
    found = x.copy()
    for k in range(len(hypothesis.nuisances), len(x)):
        c = hypothesis.coordinates[k]
        if c.null is not None and found[k] == c.null:
            found[k] += INTO * (c.start - c.null)
    return hypothesis.clipped(found)


def _scatter(errors: Array) -> Array:
    """(3,), root mean square along each axis of the place, the same for both, and of the heading."""
    place = float(np.sqrt(np.mean(errors[..., :2] ** 2)))
    return np.maximum([place, place, float(np.sqrt(np.mean(errors[..., 2] ** 2)))], LEAST)
