"""Both wheels of a robot from their commanded voltages, each with an inertia of its own, as the encoders count them.

What a body adds to the inertia may be in the motors' already, as on a stand or in a log whose motor parameters were
found with the whole robot. `physics.twin` has wheels that feel each other through the body.
"""

from dataclasses import dataclass

import numpy as np

from configs.effects.base import Slot
from physics.drivetrain.driveline import Driveline
from physics.drivetrain.held_rows import held_rows
from physics.drivetrain.rigid_wheels import RigidWheels
from physics.robot.body_inertia import BodyOnWheels
from physics.robot.model import RobotModel, through
from symolo.core.arrays import Array
from symolo.core.finite import require_finite


@dataclass(frozen=True)
class WheelLoad:
    """What a body asks of each wheel, on top of its motor's own."""

    inertia_kg_m2: float = 0.0
    body: BodyOnWheels | None = None
    """Whose centrifugal forces and caster the wheels feel."""

    @classmethod
    def of_body(cls, model: RobotModel) -> "WheelLoad":
        """Of the robot's body, but for inertia that one wheel feels of the other: little where mass is spread out."""
        body = BodyOnWheels.from_model(model)
        return cls(float(body.wheel_inertia_kg_m2[0, 0]), body)

    def torque_N_m(self, speed_rad_s: Array) -> Array:
        """On the wheels, right and left along the last axis, at their speeds (..., 2)."""
        if self.body is None:
            return np.zeros_like(speed_rad_s)
        return np.stack(self.body.load_N_m(speed_rad_s[..., 0], speed_rad_s[..., 1]), axis=-1)


NO_LOAD = WheelLoad()


def counted_turns(
    model: RobotModel, voltage_V: Array, row_s: float, begin_s: Array, load: WheelLoad = NO_LOAD
) -> Array:
    """Angles [rad] that the encoders count in each row, from rest; (T, N, 2) or (T, M, N, 2), right and left.

    Args:
        model: The robot, or M of them whose numbers are stacked, (M, 1, 1) each.
        voltage_V: (T, N, 2), right and left, each held for a row.
        row_s: Length of a row.
        begin_s: (N,), time of each trial's start since the robot was switched on.
        load: By the body, as far as it is not in the motors' numbers.

    Raises:
        ValueError: A voltage is no finite number.
        InputError: The robot has play in its gears.
    """
    require_finite(voltage_V, "voltage_V", ("row", "trial", "wheel"))
    model.require_rigid_gears("a driving robot")
    driveline = Driveline.of_robot(model)
    driveline.inertia_kg_m2 = driveline.inertia_kg_m2 + load.inertia_kg_m2
    wheels = RigidWheels(driveline, load.torque_N_m if load.body is not None else None)
    counting = model.functions(Slot.COUNTING)
    speed = np.zeros_like(voltage_V[0])
    rows = []
    for row in held_rows(driveline, voltage_V, row_s, model.input_delay_s, begin_s[:, None]):
        turned = np.zeros(())
        for part in row.parts:
            speed, further = wheels.moved(part, speed)
            turned = turned + further
        rows.append(through(counting, turned, row_s))
    return np.stack(np.broadcast_arrays(*rows))


SOLVED_AFTER = 16
"""Steps in which the share that is counted is found for an unknown speed; with a tenth lost, each leaves a third of the
error or less."""


def uncounted(model: RobotModel, counted_rad: Array, row_s: Array) -> Array:
    """Angles [rad] that the wheels have turned where the encoders counted so much in each row.

    Where two speeds give the same counts, for so many are lost at the faster one, it is the slower one.

    Args:
        model: The robot, or M of them whose numbers are stacked, (M, 1, 1) each.
        counted_rad: (..., n, 2), right and left.
        row_s: (n, 1), length of each row.
    """
    counting = model.functions(Slot.COUNTING)
    turned = counted_rad
    for _ in range(SOLVED_AFTER if counting else 0):
        again = through(counting, turned, row_s)
        turned = turned * np.divide(counted_rad, again, out=np.ones(again.shape), where=again != 0.0)
    return turned
