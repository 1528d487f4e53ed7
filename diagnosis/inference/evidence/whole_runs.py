"""Parameters of a drive fitted to whole runs, since errors that add up along a path are largest at its end.

Windows of half a second show which link of the chain is wrong. But a wheel that is 0.1 % too large is far below the
noise of a window, and a robust loss mistakes the skewness of that noise for a shift. Over a run the same error adds up
to many times the noise of the camera. Therefore the poses of each run are predicted from its first pose and the counts
alone, as in calibrations with whole paths (Borenstein and Feng, IEEE Trans. Robotics and Automation 12 (1996) 869-880;
Sousa et al., J. Intell. Robot. Syst. 105:39 (2022)), and compared with the log at PARTS points.

The errors at the points of one run are not independent: together they count as one place and one heading. The scatter
of the runs around the model is not known beforehand, so the cost is minus twice the log-likelihood with that scatter
profiled out: n times the log of the mean square, with n = 2 for the places and n = 1 for the headings of each run, plus
the priors of the nominal parameters. Effects enter by the rule of `selection`: the one with the largest fall of the
cost, if the fall is large enough to name it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit, at
from diagnosis.inference.fitting.hypothesis import CandidateEffect, Hypothesis, moved
from diagnosis.inference.selection.refusal import needed
from diagnosis.inference.selection.stepwise import MAX_EFFECTS
from diagnosis.measured.case_files.case_format import POSE
from diagnosis.measured.case_files.nominal import KnownWheels
from diagnosis.measured.measurement import Measurement
from diagnosis.predictors.pose.by_counts import Pose, seen_from_body
from diagnosis.predictors.rows import good_values
from symolo.core.arrays import Array

PARTS = 20
"""Points of a run, evenly spaced; the last one is its end."""
MIN_RUNS = 4
"""Runs from which a scatter can be estimated in addition to the parameters."""
MAX_STEPS = 12
STEP = 1e-3
"""Step of a derivative, in coordinates."""
SETTLED = 1e-3
"""Change of every coordinate at which a fit ends."""
MIN_SEEN = 0.01
"""Share of a parameter's information that is not about the heading at the start, below which whole runs do not show
the parameter: an angle of the tracked body turns each path about its start, and the little that is left of it comes
from the errors of the path."""
MIN_SCATTER = 1e-6
"""Smallest scatter [m, rad]."""
START_SHARE = 0.1
"""Share of an effect's start value at which its fit begins, since the cost has no slope at a bound."""
LOCAL_STEPS = 2
"""Steps for nuisances that enter linearly; only the weights of outliers change from one to the next."""


class WholeRuns:
    """All trials of a drive with counts and poses, each predicted from its first logged pose."""

    def __init__(self, measurement: Measurement, nominal: RobotConfig) -> None:
        self._pose = Pose(measurement, nominal)
        log = np.stack([good_values(measurement, name) for name in POSE], axis=-1)
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
        """Return robot minus log, (runs, PARTS, 3): place [m] along and across the first heading, and heading [rad]."""
        path = self._pose.path(robot, self._starts)
        return seen_from_body(self._starts[:, None, 2], path[np.stack(self._points)] - self._measured)

    def free_of_start(self, errors: Array) -> Array:
        """Return errors (..., runs, PARTS, 3) without the place errors that a wrong heading at the start causes.

        The heading comes from a single camera frame, and the tracked body may be mounted with an angle: both turn the
        whole path about its start and contain nothing about the wheels.
        """
        path = seen_from_body(self._starts[:, None, 2], self._measured - self._starts[:, None, :])[..., :2]
        across = np.stack([-path[..., 1], path[..., 0]], axis=-1)
        angle = (across * errors[..., :2]).sum(axis=(-1, -2)) / np.maximum((path**2).sum(axis=(-1, -2)), MIN_SCATTER**2)
        turned = errors.copy()
        turned[..., :2] -= angle[..., None, None] * across
        return turned


@dataclass(frozen=True)
class WholeRunFit:
    """A hypothesis fitted to whole runs."""

    hypothesis: Hypothesis
    x: Array
    """(P,), coordinates."""
    covariance: Array
    """(P, P), covariance of the coordinates."""
    cost: float
    place_m: float
    """Root mean square of the residuals of a place, along one axis."""
    heading_rad: float
    """Root mean square of the residuals of the heading."""

    @property
    def robot(self) -> RobotConfig:
        return self.hypothesis.robot(self.x)

    def std(self, effect: CandidateEffect) -> dict[str, float]:
        """Return the standard errors of an effect's parameters, in their units."""
        return self.hypothesis.std(effect, self.x, self.covariance)


def fitted_to_whole_runs(
    measurement: Measurement, hypothesis: Hypothesis, x: Array, effects: Sequence[CandidateEffect]
) -> WholeRunFit | None:
    """Return a hypothesis fitted to the runs that are not held out, with the effects that these runs need.

    Args:
        measurement: A drive with counts and poses.
        hypothesis: The hypothesis to extend; its effects stay.
        x: (P,), its coordinates, where the fit begins.
        effects: The effects that may enter.

    Returns:
        The fit, without nuisances of single sessions; None with fewer than four such runs.
    """
    trials = tuple(trial for trial in measurement.trials if not trial.holdout.any() and len(trial.t_s) > PARTS)
    if len(trials) < MIN_RUNS:
        return None
    # The heading at each start is free, which includes all that sessions add.
    hypothesis, x = hypothesis.of_robot(x)
    runs = WholeRuns(replace(measurement, trials=trials), hypothesis.nominal)
    fit = _fit(runs, hypothesis, x)
    while len(fit.hypothesis.effects) < MAX_EFFECTS:
        names = {effect.kind.name for effect in fit.hypothesis.effects}
        tried = []
        for effect in (e for e in effects if e.kind.name not in names):
            extended = fit.hypothesis.with_effect(effect)
            tried.append((effect, _fit(runs, extended, moved(fit.x, fit.hypothesis, extended))))
        accepted = [(effect, candidate) for effect, candidate in tried if fit.cost - candidate.cost > needed(effect)]
        if not accepted:
            break
        fit = min(accepted, key=lambda both: both[1].cost + 3.0 * len(both[0].coordinates))[1]
    return fit


def _fit(runs: WholeRuns, hypothesis: Hypothesis, x: Array) -> WholeRunFit:
    """Fit by Gauss-Newton steps, with a new scatter at each; the paths are almost linear in such small parameters."""
    low, high = hypothesis.bounds
    x = _off_null(hypothesis, x)
    priors = np.arange(len(x)) < len(hypothesis.nuisances)
    information = np.diag(priors.astype(float))
    for _ in range(MAX_STEPS):
        around = np.concatenate([x[None], x + STEP * np.eye(len(x))])
        raw = np.stack([runs.errors(robot) for robot in hypothesis.robots(around)])
        errors = runs.free_of_start(raw)
        # All points of a run together count as one.
        weight = 1.0 / (_scatter(errors[0]) * np.sqrt(PARTS))
        z = (errors[0] * weight).ravel()
        slopes, with_start = (((e[1:] - e[0]) * weight / STEP).reshape(len(x), -1) for e in (errors, raw))
        slopes *= (np.square(slopes).sum(axis=1) > MIN_SEEN * np.square(with_start).sum(axis=1))[:, None]
        information = slopes @ slopes.T + np.diag(priors.astype(float))
        downhill = -slopes @ z - np.where(priors, x, 0.0)
        free = (np.diag(information) > 0.0) & ~(((x <= low) & (downhill < 0.0)) | ((x >= high) & (downhill > 0.0)))
        step = np.zeros(len(x))
        step[free] = np.linalg.lstsq(information[np.ix_(free, free)], downhill[free], rcond=1e-12)[0]
        x = np.clip(x + step, low, high)
        if np.max(np.abs(step), initial=0.0) < SETTLED:
            break
    scatter = _scatter(runs.free_of_start(runs.errors(hypothesis.robot(x))))
    # Three logarithms for each run: two axes of the place and one heading, as explained above.
    cost = runs.count * float(np.log(scatter**2).sum()) + float((hypothesis.prior(x) ** 2).sum())
    covariance = np.linalg.pinv(information, rcond=1e-12, hermitian=True)
    return WholeRunFit(hypothesis, x, covariance, cost, float(scatter[0]), float(scatter[2]))


def _off_null(hypothesis: Hypothesis, x: Array) -> Array:
    """Return coordinates (P,) with those of absent effects moved off their null."""
    y = x.copy()
    for k in range(len(hypothesis.nuisances), len(x)):
        c = hypothesis.coordinates[k]
        if c.null is not None and y[k] == c.null:
            y[k] += START_SHARE * (c.start - c.null)
    return hypothesis.clipped(y)


def _scatter(errors: Array) -> Array:
    """Return the root mean squares (3,) along the two axes of the place, the same for both, and of the heading."""
    place = float(np.sqrt(np.mean(errors[..., :2] ** 2)))
    return np.maximum([place, place, float(np.sqrt(np.mean(errors[..., 2] ** 2)))], MIN_SCATTER)


def with_whole_runs(measurement: Measurement, evidence: Evidence, fit: HypothesisFit) -> HypothesisFit:
    """Return the fit with the parameters of a fit to whole runs.

    It is the same fit unless the drive has known wheels and enough runs.
    """
    if not isinstance(measurement.nominal, KnownWheels):
        return fit
    whole = fitted_to_whole_runs(measurement, fit.hypothesis, fit.x, ())
    if whole is None:
        return fit
    # The residuals stay those of the windows, as in every report. Parameters and standard errors are those of the fit
    # to whole runs; a parameter that only the windows show keeps its information from them.
    seen = ~fit.hypothesis.is_local
    information, x = np.zeros_like(fit.information), fit.x.copy()
    information[np.ix_(seen, seen)], x[seen] = np.linalg.pinv(whole.covariance, hermitian=True), whole.x
    unseen = np.flatnonzero(np.diag(information) <= 0.0)
    information[np.ix_(unseen, unseen)] = fit.information[np.ix_(unseen, unseen)]
    local = _with_local_fitted(at(evidence, fit.hypothesis, x))
    return replace(local, information=information, is_of_whole_runs=True)


def _with_local_fitted(fit: HypothesisFit) -> HypothesisFit:
    """Return a fit with the nuisances of single sessions fitted, and everything else unchanged."""
    hypothesis, x = fit.hypothesis, fit.x.copy()
    local = hypothesis.is_local
    if not local.any():
        return fit
    for _ in range(LOCAL_STEPS):
        tangents = fit.slopes[local] * (root := fit.root_weights())
        system = tangents @ tangents.T + np.eye(len(tangents))
        x[local] += np.linalg.solve(system, tangents @ (root * fit.z) - x[local])
        fit = at(fit.evidence, hypothesis, x)
    return fit
