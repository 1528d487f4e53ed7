"""One motor on a bench with the effects of its robot: steady states and step responses, without noise.

`sensors.wheels.instruments` turns current and speed into the readings of the bench. The numbers of many robots may be
stacked, (M, 1, 1) each (`physics.robot.stack`); results are then those of all of them.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from physics.drivetrain.bare_motor import bare_speeds
from physics.drivetrain.driveline import Driveline
from physics.drivetrain.held_rows import HeldVoltages, held_rows
from physics.drivetrain.motion import voltage_trend
from physics.drivetrain.shaft import ShaftState, shaft_of
from physics.robot.model import RobotModel
from symolo.core.arrays import Array, stacked_rows
from symolo.core.finite import require_finite

SETTLED = 1e-11
"""Accuracy of a steady speed, relative to the highest speed."""
MAX_STEPS = 200
MIN_FRICTION_N_M = 1e-9
TURNING = (0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
"""Shares of the highest speed at which a motor may turn although it would not start."""


@dataclass(frozen=True)
class RowHistory:
    """Influence of earlier rows on rows of steady states."""

    trend: Array
    """(N, 1), whether the size of the voltage last grew (+1) or fell (-1)."""
    heat: Array
    """(N, 1), or (M, N, 1) for M robots: share by which heat has raised the resistance."""

    @classmethod
    def from_commands(cls, model: RobotModel, voltage_V: Array, time_s: Array) -> "RowHistory":
        """Return that of rows (N,), each of which holds until the next one in time; unknown voltages count as 0 V."""
        driveline = Driveline.for_bench(model)
        order = np.argsort(time_s, kind="stable")
        back = np.argsort(order, kind="stable")
        trend = voltage_trend(voltage_V[order])[back][:, None]
        if not driveline.heats:
            return cls(trend, np.zeros_like(trend))
        heats = [np.zeros((1, 1))]
        held_V, lasts_s = np.nan_to_num(voltage_V)[order], np.diff(time_s[order])
        for volts, duration_s in zip(held_V[:-1, None, None], lasts_s.tolist(), strict=True):
            heats.append(np.asarray(driveline.heat_after(heats[-1], volts, duration_s)))
        heat = np.concatenate([np.broadcast_to(each, heats[-1].shape) for each in heats], axis=-2)
        return cls(trend, heat[..., back, :])

    def of_rows(self, rows: NDArray[np.bool_]) -> "RowHistory":
        """Return that of some of the rows."""
        return RowHistory(self.trend[rows], self.heat[..., rows, :])


def steady_states(
    model: RobotModel, voltage_V: Array, time_s: Array, supply_V: Array | None = None, past: RowHistory | None = None
) -> tuple[Array, Array]:
    """Return current [A] and speed [rad/s], (N,) or (M, N) each, reached from rest at constant voltages.

    Args:
        model: The robot, or M of them, whose right motor is on the bench.
        voltage_V: (N,), constant voltages.
        time_s: (N,), time since the motor was first switched on.
        supply_V: (N,), voltage of the supply; that of the robot by default.
        past: Influence of earlier rows; by default there are no other rows than these.

    Raises:
        ValueError: A voltage is not a finite number.
    """
    bench = _SteadyBench(model, voltage_V, time_s, supply_V, past)
    speed = bench.speed_rad_s(bench.surplus_at_rest_N_m > 0.0)
    return bench.current_A(speed)[..., 0], speed[..., 0]


@dataclass(frozen=True)
class KnownMotionStates:
    """Steady states of a motor in rows of which it is known whether it turns; (N,) or (M, N) each."""

    current_A: Array
    speed_rad_s: Array
    """Speed in the rows in which it turns; 0 if no speed is steady there."""
    surplus: Array
    """Torque at rest beyond the friction that holds, as a share of this friction: above 0 the motor starts."""


def steady_states_of_known_motion(  # noqa: PLR0917 - what the rows depend on
    model: RobotModel,
    voltage_V: Array,
    time_s: Array,
    turns: NDArray[np.bool_],
    supply_V: Array | None = None,
    past: RowHistory | None = None,
    at_rad_s: Array | None = None,
) -> KnownMotionStates:
    """Return the steady states if the motor turns in some rows and stands still in the others.

    Near the voltage at which a motor starts, a small change of its friction decides whether it does. What it reads
    there is therefore predicted for the motion that was observed.

    Args:
        model: The robot, or M of them, whose right motor is on the bench.
        voltage_V: (N,), constant voltages.
        time_s: (N,), time since the motor was first switched on.
        turns: (N,), whether the motor turns.
        supply_V: (N,), voltage of the supply; that of the robot by default.
        past: Influence of earlier rows; by default there are no other rows than these.
        at_rad_s: (N,), speed at which the current is wanted in a row in which the motor does not surely turn; NaN for
            that of `turns`.

    Raises:
        ValueError: A voltage is not a finite number.
    """
    bench = _SteadyBench(model, voltage_V, time_s, supply_V, past)
    speed = bench.speed_rad_s(turns[:, None])
    surplus = bench.surplus_at_rest_N_m / np.maximum(bench.hold_N_m, MIN_FRICTION_N_M)
    current_speed = speed if at_rad_s is None else np.where(np.isnan(at_rad_s)[:, None], speed, at_rad_s[:, None])
    return KnownMotionStates(bench.current_A(current_speed)[..., 0], speed[..., 0], surplus[..., 0])


class _SteadyBench:
    """A motor at constant voltages (N, 1)."""

    def __init__(
        self, model: RobotModel, voltage_V: Array, time_s: Array, supply_V: Array | None, past: RowHistory | None
    ) -> None:
        require_finite(voltage_V, "voltage_V", ("trial",))
        self._driveline = Driveline.for_bench(model)
        if supply_V is not None:
            self._driveline.full_supply_V = supply_V[:, None]
        self._time_s = time_s[:, None]
        past = RowHistory.from_commands(model, voltage_V, time_s) if past is None else past
        self._trend = past.trend
        self._winding = self._driveline.winding(self._time_s, past.heat)
        command = voltage_V[:, None]
        _, self._voltage_V = self._driveline.voltage_V(command, command, self._time_s, np.inf)
        self._no_load_V = self._driveline.supply_V(self._time_s)
        self._sign = np.sign(self._voltage_V)
        at_rest = self._drive_N_m(np.zeros_like(self._voltage_V))
        self.hold_N_m = self._friction_N_m(at_rest, np.zeros_like(at_rest))
        """Friction that holds the motor at rest."""
        self.surplus_at_rest_N_m = self._sign * at_rest - self.hold_N_m
        """Torque at rest beyond that friction."""

    def current_A(self, speed_rad_s: Array) -> Array:
        return self._driveline.current_A(self._voltage_V, speed_rad_s, self._no_load_V, self._winding)

    def speed_rad_s(self, turns: NDArray[np.bool_]) -> Array:
        """Return the steady speeds where the motor turns, and 0 elsewhere."""
        top = np.abs(self._voltage_V) / self._winding.torque_constant_N_m_A
        if self._driveline.may_coast:
            no_load = self._no_load_V / self._winding.torque_constant_N_m_A
            top = np.where(self._surplus_N_m(top) > 0.0, no_load, top)
        low, at_low = np.zeros_like(top), self.surplus_at_rest_N_m
        starts = at_low > 0.0
        if np.any(turns & ~starts):
            low, at_low = self._turning(top, turns & ~starts)
        moves = turns & (at_low > 0.0)
        return np.where(moves, self._sign * _root(self._surplus_N_m, low, at_low, top, moves), 0.0)

    def _turning(self, top: Array, rows: NDArray[np.bool_]) -> tuple[Array, Array]:
        """Return speeds, and the surplus there, from which the motor would go on turning; 0 if there is none.

        Friction that falls when motion begins keeps a motor at rest at voltages at which it could turn.
        """
        low, at_low = np.zeros_like(top), self.surplus_at_rest_N_m
        for share in TURNING:
            speed = share * top
            surplus = self._surplus_N_m(speed)
            better = rows & (surplus > 0.0)
            low, at_low = np.where(better, speed, low), np.where(better, surplus, at_low)
        return low, at_low

    def _drive_N_m(self, speed_rad_s: Array) -> Array:
        return self._winding.torque_constant_N_m_A * self.current_A(speed_rad_s)

    def _friction_N_m(self, drive_N_m: Array, speed_rad_s: Array) -> Array:
        return self._driveline.friction_N_m(drive_N_m, speed_rad_s, self._time_s, self._trend)

    def _surplus_N_m(self, size_rad_s: Array) -> Array:
        """Return the torque that accelerates the motor at a speed in the direction of its voltage."""
        speed = self._sign * size_rad_s
        drive = self._drive_N_m(speed)
        return self._sign * (drive - self._driveline.viscous_N_m_s_rad * speed) - self._friction_N_m(drive, speed)


def _root(
    function: Callable[[Array], Array], low: Array, at_low: Array, top: Array, is_needed: NDArray[np.bool_]
) -> Array:
    """Return the zero of a function that falls from `at_low` at `low` to below 0 at `top`, by the Illinois method.

    One step finds the zero of a straight line; kinks and curves take about ten. Every third step halves the bracket,
    which bounds the number of steps. Elements that are not needed are not iterated to the end.
    """
    high, at_high = np.zeros_like(at_low) + top, function(top)
    root, was_above = low, is_needed
    for step in range(MAX_STEPS):
        spread = at_low - at_high
        share = np.clip(at_low / np.where(spread > 0.0, spread, 1.0), 0.0, 1.0)
        halves = step % 3 == 2
        before, root = root, low + (high - low) * (np.full_like(share, 0.5) if halves else share)
        value = function(root)
        if not halves and np.all((np.abs(root - before) <= SETTLED * top) | (value == 0.0) | ~is_needed):
            break
        above = value > 0.0
        # The value at an end that stays twice is halved, so that the end does not stay for ever.
        again = np.where(above == was_above, 0.5, 1.0)
        at_low, at_high = np.where(above, value, again * at_low), np.where(above, again * at_high, value)
        low, high, was_above = np.where(above, root, low), np.where(above, high, root), above
    return root


def step_responses(
    model: RobotModel, voltage_V: Array, row_s: float, begin_s: Array | None = None
) -> tuple[Array, Array]:
    """Return current [A] and speed [rad/s] on the motor side of the gearbox at the end of each row, from rest.

    Args:
        model: The robot, or M of them, whose right motor is on the bench.
        voltage_V: (T, N), each constant for the row that ends at its sample.
        row_s: Duration of a row.
        begin_s: (N,), time of each trial's start since the motor was first switched on; 0 by default.

    Returns:
        (T, N) or (T, M, N) each. The current is that at the mean voltage of the last half millisecond of the row, in
        which a delayed command may take effect.

    Raises:
        ValueError: A voltage is not a finite number.
    """
    require_finite(voltage_V, "voltage_V", ("row", "trial"))
    driveline = Driveline.for_bench(model)
    begin = np.zeros((voltage_V.shape[1], 1)) if begin_s is None else begin_s[:, None]
    rest = np.zeros((voltage_V.shape[1], 1))
    if driveline.is_bare and not model.has_play:
        held = HeldVoltages.from_commands(driveline, voltage_V[..., None], row_s, model.input_delay_s, begin)
        speed = bare_speeds(driveline, held, rest)
        voltage = held.last_V[:, None] if held.last_V.ndim < speed.ndim else held.last_V
        winding = driveline.winding(0.0, 0.0)
        return driveline.current_A(voltage, speed, driveline.full_supply_V, winding)[..., 0], speed[..., 0]
    shaft = shaft_of(model, driveline)
    state = ShaftState.at_rest(rest.shape)
    voltages, supplies, heats, speeds = [], [], [], []
    for row in held_rows(driveline, voltage_V[..., None], row_s, model.input_delay_s, begin):
        for part in row.parts:
            state = shaft.moved(part, state)
        voltages.append(row.last_V)
        supplies.append(row.supply_V)
        heats.append(row.last_heat)
        speeds.append(state.sides.motor_rad_s)
    voltage, supply, heat, speed = (stacked_rows(rows, rest.shape) for rows in (voltages, supplies, heats, speeds))
    voltage, supply, heat = (rows[:, None] if rows.ndim < speed.ndim else rows for rows in (voltage, supply, heat))
    ends_s = begin + row_s * np.arange(1, len(speed) + 1).reshape(-1, *(1,) * (speed.ndim - 1))
    return driveline.current_A(voltage, speed, supply, driveline.winding(ends_s, heat))[..., 0], speed[..., 0]
