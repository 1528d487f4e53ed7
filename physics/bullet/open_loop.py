"""Open-loop drives in PyBullet by voltages, on an empty floor or lifted above it with free wheels."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from configs.schema.robot import RobotConfig
from configs.schema.scenario import Rates
from physics.bullet.simulation import BulletSimulation
from symolo.arena.geometry import Arena, Line
from symolo.core.arrays import Array
from symolo.core.finite import require_finite
from symolo.core.geometry.poses import PlanarPose

PHYSICS_HZ = 1000.0
"""Physics rate of the shipped scenarios; rows of any length are divided into steps of about this rate."""
STEPS_PER_CHECK = 10
"""Physics steps between two checks of contacts and yaw."""
EMPTY = Arena("empty", 1.0, 0.5, Line((), 0.015, 0.05), ())


@dataclass(frozen=True)
class OpenLoopDrive:
    """State before the first of T rows and at the end of each; wheels are right and left."""

    pose: Array
    """(T + 1, 3), x [m], y [m], yaw [rad] in W, yaw unwrapped."""
    counts: NDArray[np.int64]
    """(T + 1, 2), encoder counts since the start."""
    wheel_speed_rad_s: Array
    """(T + 1, 2), true wheel speeds."""
    current_A: Array
    """(T + 1, 2), winding currents at the voltage of the row that ends."""


def open_loop(
    robot: RobotConfig, voltage_V: Array, row_s: float, start: PlanarPose = (0.0, 0.0, 0.0), *, lifted: bool = False
) -> OpenLoopDrive:
    """Return the drive of a robot from rest.

    Args:
        robot: The robot with its effects.
        voltage_V: (T, 2), right and left, each constant for a row.
        row_s: Duration of a row; a row has a whole number of physics steps, at about PHYSICS_HZ.
        start: Pose at the beginning.
        lifted: Whether the body is held above the floor.

    Raises:
        ValueError: A voltage is not a finite number.
        InputError: The robot has play in its gears.
    """
    require_finite(voltage_V, "voltage_V", ("row", "wheel"))
    steps = max(1, round(row_s * PHYSICS_HZ))
    looks_hz = max(1, round(steps / row_s / STEPS_PER_CHECK))
    rates = Rates(physics_hz=looks_hz * STEPS_PER_CHECK, wheel_loop_hz=looks_hz, control_hz=1, camera_hz=1)
    rows = []
    with BulletSimulation(robot, EMPTY, start, rates) as world:
        if lifted:
            world.lift()
        for right_V, left_V in [(0.0, 0.0), *voltage_V.tolist()]:
            if rows:
                world.set_voltages(right_V, left_V)
                world.advance(steps)
            rows.append((world.pose(), world.encoder_counts(), world.wheel_speeds(), world.currents()))
    pose, counts, speed, current = (np.array(column) for column in zip(*rows, strict=True))
    return OpenLoopDrive(pose, counts.astype(np.int64), speed, current)
