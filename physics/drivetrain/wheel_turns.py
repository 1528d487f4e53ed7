"""Turned angles of both wheels from their commanded voltages, as the encoders count them.

The inertia of the body may already be part of the motors' inertia, as on a stand or in a log whose motor parameters
were identified with the whole robot. Otherwise the wheels accelerate each other through the body.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np

from configs.effects.base import Slot
from physics.drivetrain.bare_motor import bare_turns
from physics.drivetrain.driveline import NO_PLACE, Driveline
from physics.drivetrain.held_rows import HeldVoltages, held_rows, joined_parts
from physics.drivetrain.rigid_wheels import RigidWheels
from physics.robot.body_inertia import BodyOnWheels
from physics.robot.model import RobotModel, applied
from symolo.core.arrays import Array, stacked_rows
from symolo.core.finite import require_finite

LAG_PART_S = 0.01
"""Longest part of a row in which a voltage lags. A part has the constant voltage that brings the motor to the same
speed at its end, with which the motor turns too far on its way there, the more so the longer the part is."""


@dataclass(frozen=True)
class WheelLoad:
    """Load of the body on each wheel, in addition to its motor."""

    inertia_kg_m2: float = 0.0
    body: BodyOnWheels | None = None
    """Body by which the wheels accelerate each other, and whose centrifugal forces and caster act on them; None
    without."""
    mutual_kg_m2: float = 0.0
    """Inertia that the acceleration of one wheel has for the other one, without a `body`."""

    @classmethod
    def from_model(cls, model: RobotModel) -> "WheelLoad":
        """Return the load of the robot's body."""
        body = BodyOnWheels.from_model(model)
        return cls(float(body.wheel_inertia_kg_m2[0, 0]), body)

    @property
    def coupling_kg_m2(self) -> Array | None:
        """Inertia (2, 2) of the body that the acceleration of one wheel has for the other one."""
        if self.body is None:
            return self.mutual_kg_m2 * (1.0 - np.eye(2)) if self.mutual_kg_m2 else None
        inertia = self.body.wheel_inertia_kg_m2
        return inertia - np.diag(np.diag(inertia))

    def torque_N_m(self, speed_rad_s: Array) -> Array:
        """Return the torques (..., 2) on the wheels, right and left, at their speeds (..., 2)."""
        if self.body is None:
            return np.zeros_like(speed_rad_s)
        return np.stack(self.body.load_N_m(speed_rad_s[..., 0], speed_rad_s[..., 1]), axis=-1)


NO_LOAD = WheelLoad()


@dataclass(frozen=True)
class MeasuredRows:
    """What was measured at the beginnings of T rows of N trials, on which the torques may depend."""

    x_m: Array
    """(T, N, 1), place of the robot in W."""
    y_m: Array
    angle_rad: Array
    """(T, N, 2), angles of the wheels, right and left; NaN where not measured."""


def counted_turns(  # noqa: PLR0917 - the robot, what drives it, and when
    model: RobotModel,
    voltage_V: Array,
    row_s: float | Array,
    begin_s: Array,
    load: WheelLoad = NO_LOAD,
    parts: int = 1,
    measured: MeasuredRows | None = None,
) -> Array:
    """Return the angles [rad] that the encoders count in each row from rest, (T, N, 2) or (T, M, N, 2), right and left.

    Args:
        model: The robot, or M of them whose numbers are stacked, (M, 1, 1) or (M, N, 2) each.
        voltage_V: (T parts, N, 2), right and left, each constant for a part of a row.
        row_s: Duration of a row, one for all or (T, N).
        begin_s: (N,), time of each trial's start since the robot was switched on.
        load: Load of the body, as far as it is not part of the motors' numbers.
        parts: Number of equal parts of a row.
        measured: Places and angles; without them, the robot stays at the origin and the angles are those since rest.

    Raises:
        ValueError: A voltage is not a finite number.
        InputError: The robot has play in its gears.
    """
    require_finite(voltage_V, "voltage_V", ("row", "trial", "wheel"))
    model.require_rigid_gears("a driving robot")
    driveline = Driveline.of_robot(model)
    driveline.inertia_kg_m2 = driveline.inertia_kg_m2 + load.inertia_kg_m2
    if driveline.lags:
        finer = ceil(np.max(row_s) / parts / LAG_PART_S)
        voltage_V, parts = np.repeat(voltage_V, finer, axis=0), finer * parts
    coupling_kg_m2 = load.coupling_kg_m2
    counting = model.functions(Slot.COUNTING)
    part_s, lasting_s = _durations(row_s, parts, len(voltage_V))
    if driveline.is_bare and coupling_kg_m2 is None:
        voltages = HeldVoltages.from_commands(driveline, voltage_V, part_s, model.input_delay_s, begin_s[:, None])
        part_turns = bare_turns(driveline, voltages, np.zeros_like(voltage_V[0]))
        turns = part_turns.reshape(-1, parts, *part_turns.shape[1:]).sum(axis=1)
        return stacked_rows([applied(counting, turned, lasts) for turned, lasts in zip(turns, lasting_s, strict=True)])
    wheels = RigidWheels(driveline, None if coupling_kg_m2 is None else load.torque_N_m, coupling_kg_m2)
    speed = angle = np.zeros_like(voltage_V[0])
    rows = []
    held = held_rows(driveline, voltage_V, part_s, model.input_delay_s, begin_s[:, None])
    for number, row in enumerate(zip(*[held] * parts, strict=True)):
        turned, place_m = np.zeros(()), NO_PLACE
        if measured is not None:
            place_m = measured.x_m[number], measured.y_m[number]
            known = measured.angle_rad[number]
            angle = np.where(np.isfinite(known), known, angle) if driveline.needs_angle else angle
        for part in joined_parts(part for held_row in row for part in held_row.parts) if parts > 1 else row[0].parts:
            placed = part._replace(place_m=place_m) if driveline.needs_place else part
            speed, further = wheels.moved(placed, speed, angle)
            turned = turned + further
            angle = angle + further if driveline.needs_angle else angle
        rows.append(applied(counting, turned, lasting_s[number]))
    return stacked_rows(rows)


def _durations(row_s: float | Array, parts: int, count: int) -> tuple[float | Array, Sequence[float | Array]]:
    """Return the duration of each part of a row as `held_rows` takes it, and that of each row; `count` parts in all."""
    if isinstance(row_s, np.ndarray):
        return np.repeat(row_s[..., None] / parts, parts, axis=0), list(row_s[..., None])
    return row_s / parts, (row_s,) * (count // parts)


ITERATIONS = 16
"""Iterations for the counted share of an unknown speed; with a tenth lost, each leaves a third of the error or less."""


def true_turns(model: RobotModel, counted_rad: Array, row_s: Array) -> Array:
    """Return the angles [rad] that the wheels turned, from the angles that the encoders counted in each row.

    If two speeds give the same counts, because the faster one loses more, the result is the slower one.

    Args:
        model: The robot, or M of them whose numbers are stacked, (M, 1, 1) each.
        counted_rad: (..., n, 2), counted angles, right and left.
        row_s: (n, 1), duration of each row.
    """
    counting = model.functions(Slot.COUNTING)
    turned = counted_rad
    for _ in range(ITERATIONS if counting else 0):
        # The share that is lost depends on the unknown speed: correct by the share at the present estimate.
        again = applied(counting, turned, row_s)
        turned = turned * np.divide(counted_rad, again, out=np.ones(again.shape), where=again != 0.0)
    return turned
