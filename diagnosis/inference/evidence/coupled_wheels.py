"""Nuisance for the body of a robot, by which the wheels of a drive accelerate each other.

Without slip, a robot of mass m and moment of inertia I has the inertia m r^2 / 4 + I r^2 / b^2 at each wheel, and
m r^2 / 4 - I r^2 / b^2 between the wheels, with radius r and wheel separation b. A case states the first one, with that
of the rotor, as the inertia of a motor. The second one is 0 only if the moment of inertia is m b^2 / 4; for a robot
with a light rotor and a compact body it is a tenth of the first one or more.
"""

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.nuisances import STEP, Nuisance, Number, change_by_tolerance
from diagnosis.predictors.wheels import Wheels

NAME = "wheel_coupling"
TOLERANCE = 0.1
"""Standard deviation of the mutual inertia between robots, as a share of the inertia of a wheel."""


def wheel_coupling(evidence: Evidence, nominal: RobotConfig) -> tuple[Nuisance, ...]:
    """Return the nuisance of the coupling of the wheels; none if it is known, or no voltage drives a wheel."""
    place = 0
    for stage in evidence.stages:
        count = sum(len(observed.values) for observed in stage.observed)
        more, less = (
            stage.coupling_rad_s(nominal, sign * STEP * TOLERANCE) if isinstance(stage, Wheels) else None
            for sign in (1.0, -1.0)
        )
        if more is not None and less is not None:
            change = np.zeros(len(evidence.values))
            change[place : place + count] = np.nan_to_num(change_by_tolerance(more, less)).ravel()
            return (Nuisance(NAME, 0.0, TOLERANCE, "1", _same, change),)
        place += count
    return ()


def _same(robot: RobotConfig, value: Number) -> RobotConfig:
    """Return the robot itself, whose file states its body."""
    del value
    return robot
