"""Nuisance for the body of a robot, by which the wheels of a drive accelerate each other.

Without slip, a robot of mass m and moment of inertia I has the inertia m r^2 / 4 + I r^2 / b^2 at each wheel, and
m r^2 / 4 - I r^2 / b^2 between the wheels, with radius r and wheel separation b. A case states the first one, with that
of the rotor, as the inertia of a motor. The second one is 0 only if the moment of inertia is m b^2 / 4; for a robot
with a light rotor and a compact body it is a tenth of the first one or more.
"""

from dataclasses import dataclass

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.nuisances import STEP, Nuisance, Number, change_by_tolerance
from diagnosis.predictors.base import Stage
from diagnosis.predictors.wheels.speeds import Wheels
from diagnosis.together import CaseStage
from symolo.core.arrays import Array

NAME = "wheel_coupling"
TOLERANCE = 0.1
"""Standard deviation of the mutual inertia between robots, as a share of the inertia of a wheel."""


@dataclass(frozen=True)
class FittedCoupling:
    """The coupling of the wheels of a fit."""

    place: int
    """Index among the coordinates of the fit."""
    share: float
    """Mutual inertia as a share of the inertia of a wheel."""
    std: float


def wheel_coupling(evidence: Evidence, nominal: RobotConfig) -> tuple[Nuisance, ...]:
    """Return the nuisance of the coupling of the wheels; none if it is known, or no voltage drives a wheel."""
    changes = [change_by_coupling(stage, nominal) for stage in evidence.stages]
    if all(change is None for change in changes):
        return ()
    # Several cases of one robot have one coupling.
    whole = [
        np.zeros(sum(len(observed.values) for observed in stage.observed))
        if change is None
        else np.nan_to_num(change).ravel()
        for stage, change in zip(evidence.stages, changes, strict=True)
    ]
    return (Nuisance(NAME, 0.0, TOLERANCE, "1", _same, np.concatenate(whole)),)


def change_by_coupling(stage: Stage, nominal: RobotConfig) -> Array | None:
    """Return the change of the speeds of both wheels (2, n) by one tolerance; None if the coupling is known."""
    if not isinstance(stage, Wheels | CaseStage):
        return None
    more, less = (stage.coupling_rad_s(nominal, sign * STEP * TOLERANCE) for sign in (1.0, -1.0))
    return None if more is None or less is None else change_by_tolerance(more, less)


def fitted_coupling(fit: HypothesisFit) -> FittedCoupling | None:
    """Return the fitted coupling of the wheels; None if it is known, or no voltage drives a wheel."""
    names = [nuisance.name for nuisance in fit.hypothesis.nuisances]
    if NAME not in names:
        return None
    place = names.index(NAME)
    error = float(np.sqrt(fit.covariance[place, place]))
    return FittedCoupling(place, TOLERANCE * float(fit.x[place]), TOLERANCE * error)


def _same(robot: RobotConfig, value: Number) -> RobotConfig:
    """Return the robot itself, whose file states its body."""
    del value
    return robot
