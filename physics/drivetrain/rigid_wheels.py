"""Wheels that are one mass each with their motors, and affect each other through supply and body.

Bare motors take one exact step. What effects add to torque and friction is averaged over both ends of a step; the end
is predicted by a step with the values of the beginning (Heun's method around the exact step, of second order). Between
both ends the torque is taken as linear in the speed, and the step with it is exact again (an exponential method with a
secant in place of the Jacobian: Hochbruck and Ostermann, Acta Numerica 19 (2010) 209-286): a bridge that coasts takes
most of its damping from a motor. Where prediction and result differ by more than the tolerance, the result is the next
prediction; where they still do, the step is divided into quarters. At null values all are identical to the bit.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from physics.drivetrain.driveline import Driveline
from physics.drivetrain.held_rows import HeldPart
from physics.drivetrain.motor_arrays import HeldDrive, covered_share
from symolo.core.arrays import Array

Mask = NDArray[np.bool_]

TOLERANCE_RAD_S = 0.02
TOLERANCE = 2e-3
"""Relative to the speed, in addition to `TOLERANCE_RAD_S`."""
TOLERANCE_SHARE = 0.1
"""Share of the tolerance for the second prediction of the end of a step, before it is divided."""
MAX_RELIEF, MAX_DAMPING = 0.98, 20.0
"""Largest part of a motor's damping that the slope of a torque may take away, and largest multiple that it may add;
the battery and the time change the torque as well, without the speed."""
PARTS = 4
MAX_DEPTH = 6
NO_TURN = np.zeros(())
"""Stands for an angle that is not needed."""

Loads = tuple[Array, Array]
"""Torque on wheels at rest, and dry friction [N m]."""


class RigidWheels:
    """Exact steps of all wheels of one or of many robots, under constant voltages."""

    def __init__(
        self,
        driveline: Driveline,
        load_N_m: Callable[[Array], Array] | None = None,
        coupling_kg_m2: Array | None = None,
        *,
        needs_turn: bool = True,
    ) -> None:
        """
        Args:
            driveline: The motors.
            load_N_m: External torques, (..., wheels), as a function of speeds (..., wheels); None without any.
            coupling_kg_m2: (wheels, wheels), inertia that the acceleration of one wheel has for another, 0 on the
                diagonal and small beside the inertia of a wheel; only with `load_N_m`.
            needs_turn: Whether the angles that the wheels turn are used. Otherwise they are 0, unless an effect depends
                on them.
        """
        self._driveline = driveline
        self._load_N_m = load_N_m
        self._coupling_kg_m2 = coupling_kg_m2
        self._time_constant_s = driveline.inertia_kg_m2 / driveline.damping_N_m_s_rad
        # A torque that depends on the angle changes with the turn, and not with the speed.
        self._has_secant = driveline.adds_torque and not driveline.needs_angle
        self._needs_angle = driveline.needs_angle
        self._needs_turn = needs_turn or driveline.needs_angle
        self._min_slope = -MAX_DAMPING * driveline.damping_N_m_s_rad
        self._max_slope = MAX_RELIEF * driveline.damping_N_m_s_rad
        self._covered_by_duration: dict[float, Array] = {}

    def moved(self, part: HeldPart, speed_rad_s: Array, angle_rad: Array) -> tuple[Array, Array]:
        """Return speed [rad/s] after a period and the angle [rad] turned in it.

        Args:
            part: The period.
            speed_rad_s: Speed before it.
            angle_rad: Angle before it, since the start; used only by effects that depend on it.
        """
        driveline = self._driveline
        stall = driveline.stall_torque_N_m(part.voltage_V)
        if driveline.is_bare and self._load_N_m is None:
            covered = self._covered(part.duration_s)
            return self._held(stall, driveline.coulomb_N_m).step(speed_rad_s, part.duration_s, covered)
        # The load of a body changes little within a row and needs no finer steps.
        return self._with_effects(part, stall, (speed_rad_s, angle_rad), 0 if driveline.is_bare else MAX_DEPTH)

    def _covered(self, duration_s: float | Array) -> Array:
        """Return the covered share of a step, computed once per duration."""
        if isinstance(duration_s, np.ndarray):
            return covered_share(duration_s, self._time_constant_s)
        if duration_s not in self._covered_by_duration:
            self._covered_by_duration[duration_s] = covered_share(duration_s, self._time_constant_s)
        return self._covered_by_duration[duration_s]

    def _held(self, torque_N_m: Array, friction_N_m: Array) -> HeldDrive:
        return HeldDrive(torque_N_m, self._driveline.damping_N_m_s_rad, friction_N_m, self._driveline.inertia_kg_m2)

    def _with_effects(
        self, part: HeldPart, stall: Array, state: tuple[Array, Array], depth: int, loads: Loads | None = None
    ) -> tuple[Array, Array]:
        """Return the same for a speed and an angle.

        Args:
            part: The period.
            stall: Torque of the bare windings at rest.
            state: Speed and angle at the beginning.
            depth: How often the period may be divided.
            loads: Torque at rest and dry friction at the beginning, if they are known already.
        """
        loads = loads or self._loads_of_beginning(part, stall, state)
        speed, angle, rough = self._in_one_step(part, stall, state, loads, may_be_divided=depth > 0)
        if rough is None:
            return speed, angle
        # All wheels take the fine steps, because they share the arrays; only the rough ones use the result.
        fine_speed, angle_rad, fine_angle = *state, np.zeros(())
        duration_s = part.duration_s / PARTS
        # The first quarter begins as the whole step does, except for a torque that depends on the turn.
        first = None if self._driveline.needs_angle else loads
        for k in range(PARTS):
            quarter = part._replace(begin_s=part.begin_s + k * duration_s, duration_s=duration_s)
            at_angle = angle_rad + fine_angle if self._driveline.needs_angle else angle_rad
            state = (fine_speed, at_angle)
            fine_speed, further = self._with_effects(quarter, stall, state, depth - 1, first if k == 0 else None)
            fine_angle = fine_angle + further
        return np.where(rough, fine_speed, speed), np.where(rough, fine_angle, angle)

    def _in_one_step(
        self, part: HeldPart, stall: Array, state: tuple[Array, Array], loads: Loads, *, may_be_divided: bool
    ) -> tuple[Array, Array, Mask | None]:
        """Return speed and turn without a division of the period, and for which wheels they are rough; None for none.

        Predict with the loads of the beginning, then repeat the step with the mean of both ends. Torque that depends on
        the angle is a mean over the turn: first over that at a constant speed, then over the predicted one.
        """
        drive, covered = self._held(*loads), self._covered(part.duration_s)
        if self._needs_angle:
            ahead = drive.step(state[0], part.duration_s, covered)
        else:
            ahead = drive.speed_after(state[0], part.duration_s, covered), NO_TURN
        speed, angle = self._corrected(part, stall, state, loads, ahead)
        rough = _far_off(speed, ahead[0], 1.0) if may_be_divided else None
        if rough is None or not self._has_secant:
            return speed, angle, rough
        # Only the rough ones use the result, so that no wheel depends on others in the same arrays.
        again, angle_again = self._corrected(part, stall, state, loads, (speed, angle))
        still_rough = _far_off(again, speed, TOLERANCE_SHARE, rough)
        return np.where(rough, again, speed), np.where(rough, angle_again, angle), still_rough

    def _corrected(
        self, part: HeldPart, stall: Array, state: tuple[Array, Array], loads: Loads, ahead: tuple[Array, Array]
    ) -> tuple[Array, Array]:
        """Return speed and turn with the loads of both ends of a period.

        Args:
            part: The period.
            stall: Torque of the bare windings at rest.
            state: Speed and angle at the beginning.
            loads: Torque at rest and dry friction at the beginning.
            ahead: Predicted speed at the end, and predicted turn.
        """
        (speed_rad_s, angle_rad), (torque, friction) = state, loads
        end_rad_s, turn = ahead
        torque_ahead, friction_ahead = self._loads(
            part, stall, end_rad_s, part.begin_s + part.duration_s, (angle_rad, turn)
        )
        torque_mean, friction_mean = 0.5 * (torque + torque_ahead), 0.5 * (friction + friction_ahead)
        gained = end_rad_s - speed_rad_s
        if self._coupling_kg_m2 is not None:
            lasts = np.asarray(part.duration_s) > 0.0
            rate = np.divide(gained, part.duration_s, out=np.zeros_like(end_rad_s), where=lasts)
            torque_mean = torque_mean - rate @ self._coupling_kg_m2
        if not self._has_secant:
            covered = self._covered(part.duration_s)
            return self._moved_by(self._held(torque_mean, friction_mean), speed_rad_s, part.duration_s, covered)
        damping = self._driveline.damping_N_m_s_rad
        more = torque_ahead - torque
        slope = np.divide(more, gained, out=np.zeros(more.shape), where=gained != 0.0)
        slope = np.minimum(np.maximum(slope, self._min_slope), self._max_slope)
        torque_mean = torque_mean - 0.5 * slope * (speed_rad_s + end_rad_s)
        held = HeldDrive(torque_mean, damping - slope, friction_mean, self._driveline.inertia_kg_m2)
        covered = covered_share(part.duration_s, held.inertia_kg_m2 / held.damping_N_m_s_rad)
        return self._moved_by(held, speed_rad_s, part.duration_s, covered)

    def _moved_by(
        self, drive: HeldDrive, speed_rad_s: Array, duration_s: float | Array, covered: Array
    ) -> tuple[Array, Array]:
        """Return speed and turn after a step with constant loads."""
        if self._needs_turn:
            return drive.step(speed_rad_s, duration_s, covered)
        return drive.speed_after(speed_rad_s, duration_s, covered), NO_TURN

    def _loads_of_beginning(self, part: HeldPart, stall: Array, state: tuple[Array, Array]) -> Loads:
        speed_rad_s, angle_rad = state
        turn = part.duration_s * speed_rad_s if self._driveline.needs_angle else angle_rad
        return self._loads(part, stall, speed_rad_s, part.begin_s, (angle_rad, turn))

    def _loads(
        self, part: HeldPart, stall: Array, speed_rad_s: Array, time_s: Array, turn: tuple[Array, Array]
    ) -> Loads:
        """Return torque at rest and dry friction [N m]; `turn` is the angle at its beginning, and its size."""
        driveline = self._driveline
        torque = stall
        if driveline.adds_torque:
            winding = driveline.winding(time_s, part.heat)
            torque = torque + driveline.extra_torque_N_m(part.voltage_V, speed_rad_s, part.supply_V, winding)
        torque = torque if self._load_N_m is None else torque + self._load_N_m(speed_rad_s)
        torque = driveline.shaft_torque_N_m(torque, *turn)
        return torque, driveline.friction_N_m(torque, speed_rad_s, time_s, part.trend, part.place_m)


def _far_off(speed_rad_s: Array, predicted_rad_s: Array, share: float, among: Mask | None = None) -> Mask | None:
    """Return which speeds are far from their predictions, relative to a share of the tolerance; None for none.

    If one wheel of a robot is, all are: through the supply and the body, each changes the torque of the others.

    Args:
        speed_rad_s: Speeds (..., wheels).
        predicted_rad_s: Predicted speeds.
        share: Share of the tolerance.
        among: Wheels that count; all by default.
    """
    off = np.abs(speed_rad_s - predicted_rad_s)
    if not np.count_nonzero(off > share * TOLERANCE_RAD_S):
        return None
    rough = off > share * (TOLERANCE_RAD_S + TOLERANCE * np.abs(speed_rad_s))
    rough = rough if among is None else rough & among
    if not np.count_nonzero(rough):
        return None
    return np.broadcast_to(rough.any(axis=-1, keepdims=True), rough.shape)
