"""Nuisances of each session: what somebody sets again before a series of drives, and what is no property of the robot.

Between two sessions the markers are stuck on again, and the clocks of camera and robot are aligned again. How far the
tracked body is off therefore differs from session to session, while wheels, motors and sensors stay the same. Every
session has these errors of its own, each with a normal prior, and they are fitted together with everything else. Only
an error that all sessions share, and that is larger than the prior allows, may be an effect with a name.

If the source states no sessions, somebody may still have set the tracked body again during a long pause of a drive. Its
heading may then change at the pause. Before the pause an error of the heading is an effect of the robot.

They are small, so that the prediction is linear in them. It is linearised once at no error, and again at the errors
that were fitted then: a delay of a whole row is not ten times a delay of a tenth of it.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from configs.effects.base import Effect
from configs.schema.robot import RobotConfig
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.measured.measurement import CaseKind, Measurement
from diagnosis.nuisances import STEP, Nuisance, Number, change_by_tolerance
from sensors.effects.pose_log.marker_offset import MarkerOffset
from sensors.effects.pose_log.marker_yaw import MarkerYaw
from sensors.effects.pose_log.pose_clock_drift import PoseClockDrift
from sensors.effects.pose_log.pose_time_offset import PoseTimeOffset
from symolo.core.arrays import Array


@dataclass(frozen=True)
class SessionError:
    """An effect whose number is another one in each session."""

    effect: type[Effect]
    number: str
    """Name of its parameter."""
    tolerance: float
    """Standard deviation between sessions, in the unit of the parameter."""
    is_change: bool = False
    """Whether the number is the change since the first session, whose error is one of the robot."""


@dataclass(frozen=True)
class SessionNuisance(Nuisance):
    """An error of one session."""

    session: str = ""
    error: SessionError | None = None


SESSION_ERRORS = (
    SessionError(MarkerYaw, "angle_rad", 0.02),
    SessionError(MarkerOffset, "offset_m", 0.002),
    SessionError(PoseTimeOffset, "delay_s", 0.02),
    SessionError(PoseClockDrift, "rate", 1e-3),
)
"""A body set by eye is off by a degree and two millimetres; clocks that are aligned by hand, to a row of
50 ms; and a clock with a ceramic resonator runs wrong by a thousandth."""
AFTER_PAUSE = (SessionError(MarkerYaw, "angle_rad", 0.02, is_change=True),)
PAUSE_S = 600.0
"""Time between two trials from which the tracked body may have been set again."""
DETERMINED = 0.5
"""Standard error in tolerances up to which the data determine an error."""
FURTHEST = 3.0
"""Largest error of a session in tolerances, of either sign, at which its predictions are linearised. If the fitted
errors of all sessions are at least as large and have the same sign, they may be one effect of the robot."""
VISIBLE = 1e-3
"""Change of a sample in sigmas, by one tolerance, from which the data show an error at all."""


def session_nuisances(
    measurement: Measurement, evidence: Evidence, nominal: RobotConfig, around: HypothesisFit | None = None
) -> tuple[SessionNuisance, ...]:
    """Return the nuisances of the sessions of a measurement, or those after long pauses if it states no sessions.

    Args:
        measurement: The measurement.
        evidence: Its samples.
        nominal: The robot without effects of sessions.
        around: A fit with such nuisances, at whose errors the predictions are linearised; at none by default.
    """
    return tuple(_nuisances(measurement, evidence, nominal, {} if around is None else _sizes(around)))


def _nuisances(
    measurement: Measurement, evidence: Evidence, nominal: RobotConfig, sizes: Mapping[tuple[str, SessionError], float]
) -> Iterator[SessionNuisance]:
    trial_sessions, errors = [trial.session for trial in measurement.trials], SESSION_ERRORS
    sessions = tuple(dict.fromkeys(session for session in trial_sessions if session))
    if not sessions:
        trial_sessions, errors = _after_pauses(measurement), AFTER_PAUSE
        sessions = tuple(dict.fromkeys(trial_sessions))[1:]
    if not sessions:
        return
    evidence, session = evidence.as_measured(), np.array(trial_sessions)[evidence.trial]
    (bare,) = evidence.predicted([nominal]).mean
    for name in sessions:
        here = (session == name) & np.isfinite(evidence.values)
        x = np.array([sizes.get((name, error), 0.0) for error in errors])
        # Either sign is possible, and a delay interpolates between other rows than its negative.
        # A step of a drifting clock is less than a row at the end of a minute.
        steps = STEP * np.eye(len(errors))
        robots = [_with_errors(nominal, errors, sizes) for sizes in (x, *(x + steps), *(x - steps))]
        at, *beside = np.where(here, evidence.predicted(robots).mean - bare, 0.0)
        more, less = np.split(np.array(beside), 2)
        changes = change_by_tolerance(more, less)
        rest = at - x @ changes
        for error, change in zip(errors, changes, strict=True):
            if np.abs(change / evidence.sd)[evidence.fit].max(initial=0.0) > VISIBLE:
                title = f"{error.effect.name} of session {name}"
                unit = error.effect.parameters()[error.number].unit
                yield SessionNuisance(title, 0.0, error.tolerance, unit, _same, change, rest, name, error)
                rest = None


def _after_pauses(measurement: Measurement) -> list[str]:
    """Return for each trial of a drive the name of the first trial since the last long pause."""
    names: list[str] = []
    ended_s = -np.inf
    for trial in measurement.trials if measurement.kind is CaseKind.DRIVE_LOG else ():
        begins_s = trial.begins_s or 0.0
        names.append(trial.name if begins_s - ended_s > PAUSE_S else names[-1])
        ended_s = begins_s + float(trial.t_s[-1])
    return names


def _sizes(fit: HypothesisFit) -> Mapping[tuple[str, SessionError], float]:
    """Return the fitted errors in tolerances, by session and kind, as far as a session has them."""
    return {
        (n.session, n.error): min(max(x, -FURTHEST), FURTHEST)
        for n, x in zip(fit.hypothesis.nuisances, fit.x.tolist(), strict=False)
        if isinstance(n, SessionNuisance) and n.error is not None
    }


@dataclass(frozen=True)
class FittedError:
    """The fitted error of one session."""

    session: str
    effect: str
    number: str
    """Name of the effect's parameter."""
    value: float
    std: float
    """Standard error."""
    unit: str
    is_change: bool = False
    """Whether the value is the change at the pause before the trial `session`."""


def fitted_errors(fit: HypothesisFit) -> tuple[FittedError, ...]:
    """Return the errors of all sessions that the data determine better than their priors do."""
    errors = np.sqrt(np.diag(fit.covariance)).tolist()
    return tuple(
        FittedError(
            n.session,
            n.error.effect.name,
            n.error.number,
            x * n.tolerance,
            error * n.tolerance,
            n.unit,
            n.error.is_change,
        )
        for n, x, error in zip(fit.hypothesis.nuisances, fit.x.tolist(), errors, strict=False)
        if isinstance(n, SessionNuisance) and n.error is not None and error < DETERMINED
    )


def within_sessions(fit: HypothesisFit) -> Collection[type[Effect]]:
    """Return the effects that are no effects of the robot, since the sessions share no large error of one sign."""
    sizes: dict[type[Effect], list[float]] = {}
    for (_, error), size in _sizes(fit).items():
        if not error.is_change:
            sizes.setdefault(error.effect, []).append(size)
    return {effect for effect, each in sizes.items() if min(each) < FURTHEST and max(each) > -FURTHEST}


def _with_errors(robot: RobotConfig, errors: Sequence[SessionError], sizes: Array) -> RobotConfig:
    """Return a robot with the errors of a session, given in tolerances, on top of its effects."""
    for error, size in zip(errors, sizes.tolist(), strict=True):
        present = robot.effects.get(error.effect)
        before = 0.0 if present is None else float(getattr(present, error.number))
        robot = robot.with_effect(error.effect.model_construct(**{error.number: before + size * error.tolerance}))
    return robot


def _same(robot: RobotConfig, value: Number) -> RobotConfig:
    """Return the robot itself, of which an error of a session is no part."""
    del value
    return robot
