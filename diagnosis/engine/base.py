"""Who drives the robots: PyBullet, or the twin that fits are made with."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from configs.schema.robot import RobotConfig
from physics.robot.body_inertia import BodyOnWheels
from physics.robot.model import RobotModel
from physics.twin import KinematicTwin
from symolo.core.arrays import Array

MIN_SHARE = 0.05
"""Of a motor's inertia and friction, that is left to it when those of a body are taken out."""
TWIN_STEP_S = 0.005


@dataclass(frozen=True)
class Driven:
    """At the ends of T rows, and before the first."""

    pose: Array
    """(T + 1, 3), x [m], y [m], yaw [rad] from where it began."""
    counts: NDArray[np.int64]
    """(T + 1, 2), right and left."""


Driver = Callable[[RobotConfig, Array, float], Driven]
"""Drives a robot from rest by voltages (T, 2), right and left, each held for a row of that length [s]."""


def by_pybullet(robot: RobotConfig, voltage_V: Array, row_s: float) -> Driven:
    from physics.bullet.open_loop import open_loop  # noqa: PLC0415 - loads pybullet, where it is asked for

    found = open_loop(robot, voltage_V, row_s)
    return Driven(found.pose, found.counts)


def by_twin(robot: RobotConfig, voltage_V: Array, row_s: float) -> Driven:
    parts = max(1, round(row_s / TWIN_STEP_S))
    twin = KinematicTwin(RobotModel.from_config(robot), row_s / parts)
    found = twin.drive(np.repeat(voltage_V, parts, axis=0)[:, None], np.zeros((1, 3)))
    return Driven(found.pose[::parts, 0], found.counts[::parts, 0])


PYBULLET, TWIN = "PyBullet", "twin"
DRIVERS: Mapping[str, Driver] = MappingProxyType({PYBULLET: by_pybullet, TWIN: by_twin})


def without_body(robot: RobotConfig) -> RobotConfig:
    """The robot whose motors' numbers hold its body, with that taken out of them, for an engine that adds it.

    A measured case gives inertia and friction as they show at the motor, the whole robot with them.
    """
    body, motor = BodyOnWheels.from_model(RobotModel.from_config(robot)), robot.motor
    inertia = float(body.wheel_inertia_kg_m2[0, 0])
    friction = 0.25 * robot.drive.wheel_diameter_m * body.caster_force_N
    numbers = {
        "rotor_inertia_kg_m2": less(motor.rotor_inertia_kg_m2, inertia),
        "coulomb_friction_N_m": less(motor.coulomb_friction_N_m, friction),
    }
    return robot.model_copy(update={"motor": motor.model_copy(update=numbers)})


def less(whole: float, part: float) -> float:
    """What is left of a motor's number, and never nothing."""
    return max(whole - part, MIN_SHARE * whole)
