"""Errors of the predictions of unseen runs, and warnings where an effect is used outside the range of its data.

The variance of a prediction has three parts. The noise is that of the readings to which the model was fitted. The
parameters have the covariance of the fit, by which the prediction is off to first order. And an effect is a law: where
a run leaves the range in which the effect was seen, the law may go on otherwise than it begins.

The third part is a standard deviation of |change by the effect| ln(1 + d), in which d is the distance from the range,
relative to its size. That is the error of a power law whose exponent is off by one: an effect that grows linearly with
a speed may as well stay constant, or grow with its square. Nothing in the data says more.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.diagnose import Diagnosis
from diagnosis.discovery.law import DiscoveredLaw
from diagnosis.inference.evidence.coupled_wheels import change_by_coupling, fitted_coupling
from diagnosis.inference.fitting.coordinate import STEP
from diagnosis.inference.fitting.fit import NUISANCE_STEP
from diagnosis.inference.naming.named_effect import NamedEffect
from diagnosis.inference.naming.seen_range import conditions
from diagnosis.inference.unexplained.adequacy import change_by
from diagnosis.measured.case_files.case_format import RANGES
from diagnosis.measured.measurement import CaseKind, Measurement
from diagnosis.predictors.base import ROW_TIME
from diagnosis.predictors.pose.by_counts import COMPONENTS, Pose, seen_from_body
from diagnosis.predictors.pose.dead_reckoning import path_sd
from diagnosis.predictors.pose.pose_noise import PoseNoise
from diagnosis.unseen import Columns, UnseenInputs, unseen_inputs
from symolo.core.arrays import Array

SD = "sd_"
"""Beginning of the name of a column with the standard deviations of readings."""
SWEPT = ("distance_m", "u_cmd_V")
"""Conditions that are swept on a bench."""
SIZE = "its own size"
"""Name of the condition that an effect is not larger than it was where it was seen. It sees combinations of conditions
that lie inside the range of each one."""
MARGIN = 0.1
"""Distance from the range, relative to its size, up to which a run counts as inside for a warning."""
MIN_SHARE = 0.01
"""Smallest share of the samples outside the range that is worth a warning."""
UNDETERMINED = 1.0
"""Standard deviation, in coordinates of the fit, of a parameter that the data do not determine."""


@dataclass(frozen=True)
class Beyond:
    """A condition in which unseen runs leave the range where an effect was seen."""

    effect: str
    condition: str
    low: float
    high: float
    furthest: float
    """Value furthest from the range."""
    share: float
    """Share of the samples outside the range."""

    @property
    def text(self) -> str:
        """Return what is used outside its range, and how far, as a line of a list."""
        share = f"{100.0 * self.share:.0f} % of the samples are outside"
        if self.condition.startswith(SIZE):
            quantity = self.condition.removeprefix(f"{SIZE} in ")
            return (
                f"{self.effect} changes {quantity} by up to {self.furthest:.3g}, and was seen with changes of up to "
                f"{self.high:.3g}; {share}"
            )
        return (
            f"{self.effect} is used as far as {self.condition} = {self.furthest:.3g}, and was seen from "
            f"{self.low:.3g} to {self.high:.3g}; {share}"
        )


@dataclass(frozen=True)
class UnseenPrediction:
    """Predictions of the readings of one file of inputs."""

    file: str
    columns: Columns
    """(n,) readings by name, and their standard deviations by `SD` and this name."""
    beyond: tuple[Beyond, ...]
    along: tuple[str, Array]
    """Name and values (n,) of what a bench sweeps, or of the time."""

    @property
    def readings(self) -> tuple[str, ...]:
        """Names of the readings."""
        return tuple(name for name in self.columns if not name.startswith(SD))


def predictions(diagnosis: Diagnosis, unseen: Mapping[str, Measurement]) -> tuple[UnseenPrediction, ...]:
    """Return the readings of the extended robot in unseen runs, with standard deviations.

    Args:
        diagnosis: The diagnosis of a case.
        unseen: Inputs of its unseen runs by file name, as `read_blind` returns them.
    """
    # Covariates that are predicted, such as the speed of a motor, are those of the nominal robot, as in the ranges.
    inputs = unseen_inputs(diagnosis.measurement, diagnosis.nominal, unseen)
    return tuple(_predicted(diagnosis, each) for each in inputs)


def _predicted(diagnosis: Diagnosis, inputs: UnseenInputs) -> UnseenPrediction:
    coupled = dict(_coupled(diagnosis, inputs))
    slopes, covariance = _around(diagnosis, list(coupled))
    means = inputs.means([diagnosis.extended, *slopes])
    by_coupling = sum((diagnosis.fit.x[place] * change for place, change in coupled.items()), start=np.zeros(1))
    mean = means[:, 0] + by_coupling
    moved = [means[:, 1:] - means[:, :1], *(change[:, None] for change in coupled.values())]
    changes = np.nan_to_num(np.concatenate(moved, axis=1))
    by_parameters = np.einsum("kin,ij,kjn->kn", changes, covariance, changes)
    variance = _noise(diagnosis, inputs, mean) ** 2 + np.maximum(by_parameters, 0.0)
    beyond: list[Beyond] = []
    for named in diagnosis.fitted_effects:
        without = _without(diagnosis, named)
        distance, left = _distance(diagnosis, named, inputs, without)
        beyond += left
        if left or any(row.any() for row in distance):
            variance += _extrapolated(inputs, mean, inputs.means([without])[:, 0] + by_coupling, distance) ** 2
    sds = np.where(np.isfinite(mean), np.sqrt(variance), np.nan)
    columns = dict(zip(inputs.names, mean, strict=True))
    columns |= {f"{SD}{name}": sd for name, sd in zip(inputs.names, sds, strict=True)}
    return UnseenPrediction(inputs.file, columns, tuple(beyond), _along(inputs))


def _along(inputs: UnseenInputs) -> tuple[str, Array]:
    swept = [covariate for covariate in inputs.observed[0].covariates if covariate.name in SWEPT]
    is_bench = bool(swept) and not inputs.observed[0].is_series
    return (swept[0].name, swept[0].values) if is_bench else (ROW_TIME, inputs.t_s)


def _coupled(diagnosis: Diagnosis, inputs: UnseenInputs) -> Iterator[tuple[int, Array]]:
    """Yield the coordinate of the coupling of the wheels, if it is fitted, and the changes (K, n) by a step of 1."""
    coupling, change = fitted_coupling(diagnosis.fit), change_by_coupling(inputs.stage, diagnosis.nominal)
    if coupling is not None and change is not None:
        yield coupling.place, change


def _around(diagnosis: Diagnosis, linear: Sequence[int]) -> tuple[list[RobotConfig], Array]:
    """Return the robots (P) that are one step off along each coordinate of the robot, and the covariance in such steps.

    Args:
        diagnosis: The diagnosis.
        linear: Coordinates that are no property of the robot; they come last in the covariance, with steps of 1.
    """
    fit = diagnosis.fit
    hypothesis, x = fit.hypothesis.of_robot(fit.x)
    columns = [*np.flatnonzero(~fit.hypothesis.is_local).tolist(), *linear]
    covariance = fit.covariance[np.ix_(columns, columns)].copy()
    unknown = ~np.isfinite(np.diag(covariance))
    covariance[unknown], covariance[:, unknown] = 0.0, 0.0
    covariance[unknown, unknown] = UNDETERMINED**2
    steps = np.full(len(x), STEP)
    steps[: len(hypothesis.nuisances)] = NUISANCE_STEP
    steps = np.where(x + steps > hypothesis.bounds[1], -steps, steps)
    scale = np.append(steps, np.ones(len(linear)))
    return hypothesis.robots(x + np.diag(steps)), covariance / np.outer(scale, scale)


def _without(diagnosis: Diagnosis, named: NamedEffect | DiscoveredLaw) -> RobotConfig:
    """Return the extended robot with one effect as the nominal robot has it, or without it."""
    robot = diagnosis.extended
    present = diagnosis.nominal.effects.get(named.effect.kind)
    effects = robot.effects.without(named.name) if present is None else robot.effects.with_effect(present)
    return robot.model_copy(update={"effects": effects})


def _noise(diagnosis: Diagnosis, inputs: UnseenInputs, mean: Array) -> Array:
    """Return the standard deviations (K, n) of the noise of readings."""
    fit, evidence = diagnosis.fit, diagnosis.evidence
    levels = {o.name: level for o, level in zip(evidence.observed, fit.noise.levels.tolist(), strict=True)}
    if isinstance(inputs.stage, Pose) and inputs.starts is not None:
        noise, robot = PoseNoise.from_measurement(diagnosis.measurement), diagnosis.extended
        sds = path_sd(mean.T, inputs.stage.travel_m(robot), inputs.stage.trials, noise, robot.drive.track_m)
        return sds * np.array([[levels.get(name, 1.0)] for name, _ in COMPONENTS])
    if diagnosis.measurement.kind in {CaseKind.MOTOR_STEADY, CaseKind.MOTOR_STEP}:
        # The noise of a motor's channels is one number each, which belongs to the readings and not to the inputs.
        places = {observed.name: place for observed, place in zip(evidence.observed, evidence.places, strict=True)}
        return np.stack([np.full(mean.shape[1], np.median(fit.sd[places[name]])) for name in inputs.names])
    predicted = inputs.stage.predict([diagnosis.extended])
    stated: Array = np.stack([np.broadcast_to(p.sd, p.mean.shape)[0] for p in predicted])
    sds = stated * np.array([[levels.get(name, 1.0)] for name in inputs.names])
    if diagnosis.random_drift is None:
        return sds
    drifts = np.array([[name in RANGES] for name in inputs.names])
    return np.hypot(sds, drifts * diagnosis.random_drift.effect.sd_m)


def _distance(
    diagnosis: Diagnosis, named: NamedEffect | DiscoveredLaw, inputs: UnseenInputs, without: RobotConfig
) -> tuple[list[Array], list[Beyond]]:
    """Return the distances (n,) of the samples of each quantity of the stage from the range of an effect, and warnings.

    Distances are relative to the size of the range, and 0 inside. Time is no condition: what an effect becomes with
    time shows in its size.
    """
    seen = {each.covariate: (each.low, each.high) for each in named.ranges if each.covariate != ROW_TIME}
    largest = _largest_changes(diagnosis, named)
    distances: list[Array] = []
    values: dict[str, list[Array]] = {}
    predictions = inputs.stage.predict([diagnosis.extended, without])
    readings = {
        observed.name: predicted.mean[0] for observed, predicted in zip(inputs.observed, predictions, strict=True)
    }
    for observed, predicted in zip(inputs.observed, predictions, strict=True):
        size = f"{SIZE} in {observed.name}"
        if (highest := largest.get(observed.name, 0.0)) > 0.0:
            seen[size] = (0.0, highest)
        change = np.nan_to_num(np.abs(predicted.mean[0] - predicted.mean[1]))
        covariates = (*conditions(observed, readings), (size, change))
        present = [(name, row_values) for name, row_values in covariates if name in seen]
        distance = np.zeros(len(observed.values))
        for name, row_values in present:
            values.setdefault(name, []).append(row_values)
            distance = np.maximum(distance, relative_distance(row_values, *seen[name]))
        distances.append(distance)
    return distances, list(_left(named, {name: np.concatenate(parts) for name, parts in values.items()}, seen))


def relative_distance(values: Array, low: float, high: float) -> Array:
    """Return the distances of values from a range, relative to its size; 0 inside, or where a value is not known.

    The size of a range on both sides of zero is that of its larger side: a speed that was seen in both directions is
    as far beyond as one that was seen in one.
    """
    size = max(-low, high) if low < 0.0 < high else high - low
    size = size if size > 0.0 else max(abs(low), abs(high), 1e-12)
    beyond: Array = np.maximum(np.maximum(low - values, values - high), 0.0) / size
    return np.nan_to_num(beyond)


def _left(
    named: NamedEffect | DiscoveredLaw, values: Mapping[str, Array], seen: Mapping[str, tuple[float, float]]
) -> Iterator[Beyond]:
    for name, row_values in values.items():
        distance = relative_distance(row_values, *seen[name])
        share = float(np.mean(distance > MARGIN)) if len(distance) else 0.0
        if share > MIN_SHARE:
            yield Beyond(named.effect.name, name, *seen[name], float(row_values[np.argmax(distance)]), share)


def _largest_changes(diagnosis: Diagnosis, named: NamedEffect | DiscoveredLaw) -> dict[str, float]:
    """Return the largest change by an effect of each quantity, in the rows in which it was seen."""
    evidence, nominal = diagnosis.evidence, diagnosis.selection.nominal
    rows = evidence.with_rows(fit=evidence.fit | evidence.heldout)
    change = np.abs(change_by(rows, nominal, diagnosis.fit, named.effect) * nominal.sd)
    return {
        observed.name: float(change[place].max(initial=0.0))
        for observed, place in zip(evidence.observed, evidence.places, strict=True)
    }


def _extrapolated(inputs: UnseenInputs, mean: Array, without: Array, distances: Sequence[Array]) -> Array:
    """Return the standard deviations (K, n) by the unknown law of an effect outside its range."""
    weights = [np.log1p(distance) for distance in distances]
    if isinstance(inputs.stage, Pose) and inputs.starts is not None:
        # What an effect does to single rows adds up along a path.
        weight = inputs.stage.by_rows(np.max(weights, axis=0))
        return np.abs(_path_of(_mixed(mean.T, without.T, weight, inputs.stage), mean.T, inputs.stage).T - mean)
    change: Array = np.abs(mean - without)
    return np.stack(weights) * np.nan_to_num(change)


def _mixed(path: Array, other: Array, weight: Array, stage: Pose) -> Array:
    """Return the steps (n, 3) of one path, moved by a weight (n,) times their difference to those of the other."""
    one, two = (_steps(each, stage) for each in (path, other))
    return one + weight[:, None] * (two - one)


def _steps(path: Array, stage: Pose) -> Array:
    """Return the changes of pose (n, 3) since the row before, in the frame of its body; 0 in the first of a trial."""
    change = np.diff(path, axis=0, prepend=path[:1])
    steps = seen_from_body(np.append(path[:1, 2], path[:-1, 2]), change)
    steps[np.cumsum([0, *stage.trials[:-1]])] = 0.0
    return steps


def _path_of(steps: Array, path: Array, stage: Pose) -> Array:
    """Return the poses (n, 3) along steps, from the first pose of each trial of a path."""
    poses, begin = np.empty_like(path), 0
    for rows in stage.trials:
        part = slice(begin, begin + rows)
        yaw = path[begin, 2] + np.cumsum(steps[part, 2])
        before = np.append(path[begin, 2], yaw[:-1])
        moved = seen_from_body(-before, steps[part])
        poses[part, :2] = path[begin, :2] + np.cumsum(moved[:, :2], axis=0)
        poses[part, 2] = yaw
        begin += rows
    return poses
