"""Drivers of the robots, PyBullet or the fast twin that is used for fits, and the stages that they simulate."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from configs.schema.robot import RobotConfig
from diagnosis.predictors.base import Observed, Predicted
from physics.robot.body_inertia import BodyOnWheels
from physics.robot.model import RobotModel
from physics.twin import KinematicTwin
from symolo.core.arrays import Array
from symolo.core.geometry.poses import PlanarPose

MIN_SHARE = 0.05
"""Smallest share of a motor's inertia and friction that remains when those of the body are subtracted."""
TWIN_STEP_S = 0.005


@dataclass(frozen=True)
class DrivenStates:
    """States at the ends of T rows, and before the first."""

    pose: Array
    """(T + 1, 3), x [m], y [m], yaw [rad] in W."""
    counts: NDArray[np.int64]
    """(T + 1, 2), counts of the right and the left encoder."""


ORIGIN = (0.0, 0.0, 0.0)
Driver = Callable[[RobotConfig, Array, float, PlanarPose], DrivenStates]
"""Function that drives a robot from rest at a pose by voltages (T, 2), right and left, each held for a row of a length
[s].
"""


def by_pybullet(robot: RobotConfig, voltage_V: Array, row_s: float, start: PlanarPose = ORIGIN) -> DrivenStates:
    from physics.bullet.open_loop import open_loop  # noqa: PLC0415 - loads pybullet, which only this needs

    states = open_loop(robot, voltage_V, row_s, start)
    return DrivenStates(states.pose, states.counts)


def by_twin(robot: RobotConfig, voltage_V: Array, row_s: float, start: PlanarPose = ORIGIN) -> DrivenStates:
    parts = max(1, round(row_s / TWIN_STEP_S))
    twin = KinematicTwin(RobotModel.from_config(robot), row_s / parts)
    states = twin.drive(np.repeat(voltage_V, parts, axis=0)[:, None], np.array([start]))
    return DrivenStates(states.pose[::parts, 0], states.counts[::parts, 0])


PYBULLET, TWIN = "PyBullet", "twin"
DRIVERS: Mapping[str, Driver] = MappingProxyType({PYBULLET: by_pybullet, TWIN: by_twin})


def without_body(robot: RobotConfig) -> RobotConfig:
    """Return a robot without the inertia and friction of its body in the motors, for an engine that adds them.

    The inertia and friction of a measured case are those at the motor, which include the whole robot.
    """
    body, motor = BodyOnWheels.from_model(RobotModel.from_config(robot)), robot.motor
    inertia = float(body.wheel_inertia_kg_m2[0, 0])
    friction = 0.25 * robot.drive.wheel_diameter_m * body.caster_force_N
    numbers = {
        "rotor_inertia_kg_m2": less(motor.rotor_inertia_kg_m2, inertia),
        "coulomb_friction_N_m": less(motor.coulomb_friction_N_m, friction),
    }
    return robot.with_section("motor", numbers)


def less(whole: float, part: float) -> float:
    """Return a motor parameter without the part of the body, at least MIN_SHARE of it."""
    return max(whole - part, MIN_SHARE * whole)


class EngineStage(ABC):
    """A stage that an engine simulates, one robot after the other; rows that are not held out may be NaN."""

    name: str
    observed: tuple[Observed, ...]
    at_once = 2

    def predict(self, robots: Sequence[RobotConfig]) -> tuple[Predicted, ...]:
        each = [self._means(robot) for robot in robots]
        return tuple(
            Predicted(np.stack([means[k] for means in each]), observed.sd) for k, observed in enumerate(self.observed)
        )

    @abstractmethod
    def _means(self, robot: RobotConfig) -> Sequence[Array]:
        """Return the predicted means (n,) of each observed quantity."""
