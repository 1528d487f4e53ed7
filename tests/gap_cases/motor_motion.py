"""A motor against time: one mass, or two with play between them; many worlds and trials side by side.

Between the moments at which it starts, stops or turns round, the motion is smooth, and the midpoint rule with steps of
a millisecond, a hundredth of the motor's time constant, is exact to far below the noise; those moments are found inside
the step. Play is stepped at a quarter of that. Whether the two sides push each other is decided by what each would do
alone; where they meet is found inside the step.
"""

from collections.abc import Sequence

import numpy as np

from .case import Array, World
from .motor_law import Motors, column

STEP_S = 1e-3
PLAY_STEP_S = 2.5e-4


def drive_voltage(command: Array, row_s: float, step_s: float, delay_s: Array) -> Array:
    """Mean of the delayed command over every step, (V, N, M).

    Args:
        command: (N, T), each held over the row that ends at its sample.
        row_s: Length of a row.
        step_s: Of a step, a whole number of which makes a row.
        delay_s: (V,).
    """
    trials, rows = command.shape
    edges = step_s * np.arange(round(rows * row_s / step_s) + 1)
    nodes = row_s * np.arange(rows + 1)
    area = np.concatenate([np.zeros((trials, 1)), np.cumsum(row_s * command, axis=1)], axis=1)
    delayed = np.array([[np.interp(edges - d, nodes, area[k]) for k in range(trials)] for d in delay_s])
    return np.diff(delayed, axis=2) / step_s


def responses(
    motors: Motors, worlds: Sequence[World], command: Array, row_s: float, begin_s: Array, shares: tuple[float, float]
) -> tuple[Array, Array, Array]:
    """Current at the rows (V, N, T); speed of the motor side at the ends of all steps (V, N, M + 1), and their times.

    Args:
        motors: Of those worlds.
        worlds: V of them.
        command: (N, T) volts.
        row_s: Length of a row.
        begin_s: (N,), session time of each trial's start.
        shares: Of inertia and friction on the motor side.
    """
    rows = command.shape[1]
    gaps = np.array([w.value("gear_backlash", "gap_rad", 0.0) for w in worlds])
    times = STEP_S * np.arange(round(rows * row_s / STEP_S) + 1)
    speed = np.zeros((len(worlds), len(command), len(times)))
    current = np.zeros((len(worlds), *command.shape))
    for play in (False, True):
        chosen = np.flatnonzero((gaps > 0.0) == play).tolist()
        if not chosen:
            continue
        some, step_s = motors.pick(chosen), PLAY_STEP_S if play else STEP_S
        delay = np.array([worlds[k].value("input_delay", "delay_s", 0.0) for k in chosen])
        lag = column([worlds[k].value("actuator_lag", "time_constant_s", 0.0) for k in chosen])
        voltage = drive_voltage(command, row_s, step_s, delay)
        if play:
            found = _with_play(some, voltage, lag, begin_s, shares, column(gaps[chosen]))
        else:
            found = _one_mass(some, voltage, lag, begin_s)
        per_row, stride = round(row_s / step_s), round(STEP_S / step_s)
        current[chosen] = found[0][..., per_row - 1 :: per_row]
        speed[chosen] = found[1][..., ::stride]
    return current, speed, times


def _held(state: Array, command: Array, lag_s: Array, after_s: float) -> Array:
    """What a first-order lag makes of a command, so long after `state`; the command itself where there is no lag."""
    rest = np.where(lag_s > 0.0, np.exp(-after_s / np.where(lag_s > 0.0, lag_s, 1.0)), 0.0)
    return command + (state - command) * rest


def _one_mass(motors: Motors, voltage: Array, lag: Array, begin_s: Array) -> tuple[Array, Array]:
    speed = np.zeros(voltage.shape[:2])
    state, angle = np.zeros_like(speed), np.zeros_like(speed)
    speeds, currents = [speed], []
    for k in range(voltage.shape[2]):
        command, time = voltage[..., k], begin_s + k * STEP_S
        first, middle, end = (_held(state, command, lag, share * STEP_S) for share in (0.0, 0.5, 1.0))
        before, speed = speed, step(motors, speed, (first, middle, end), time, STEP_S, angle)
        angle = angle + 0.5 * STEP_S * (before + speed)
        state = end
        speeds.append(speed)
        currents.append(motors.current_A(end, speed))
    return np.stack(currents, axis=-1), np.stack(speeds, axis=-1)


def step(
    motors: Motors,
    speed: Array,
    voltages: tuple[Array, Array, Array],
    time: Array,
    step_s: float,
    angle: Array | float = 0.0,
) -> Array:
    """Speed after one step of the midpoint rule; `voltages` are those at its beginning, middle and end.

    A wheel at rest breaks away in the direction of the voltage, or of a ripple that is stronger than its torque.
    """
    first, middle, end = voltages
    rests = speed == 0.0
    ripple = motors.ripple_N_m(np.asarray(angle))
    stall = first * motors.constant / motors.resistance - ripple if motors.ripples else first
    direction = np.sign(np.where(rests, stall, speed))
    surplus = motors.surplus_N_m(first, direction, speed, time, ripple)
    held = rests & (surplus <= 0.0)
    half = speed + 0.5 * step_s * direction * surplus / motors.inertia
    ripple = motors.ripple_N_m(angle + 0.5 * step_s * speed)
    after = speed + step_s * direction * motors.surplus_N_m(middle, direction, half, time, ripple) / motors.inertia
    crossed = (direction * after < 0.0) & ~held
    after = np.where(held, 0.0, after)
    if not crossed.any():
        return after
    # It stops where it crosses zero, and goes on the other way if the motor is strong enough for that.
    before_rest = np.where(crossed, speed / np.where(crossed, speed - after, 1.0), 0.0)
    zero = np.zeros_like(speed)
    pull = np.sign(end * motors.constant / motors.resistance - ripple if motors.ripples else end)
    onward = np.maximum(motors.surplus_N_m(end, pull, zero, time, ripple), 0.0)
    return np.where(crossed, pull * onward * (1.0 - before_rest) * step_s / motors.inertia, after)


def _with_play(
    motors: Motors, voltage: Array, lag: Array, begin_s: Array, shares: tuple[float, float], gap: Array
) -> tuple[Array, Array]:
    h = PLAY_STEP_S
    inertia_motor, inertia_load = shares[0] * motors.inertia, (1.0 - shares[0]) * motors.inertia
    motor = np.zeros(voltage.shape[:2])
    load, angle, side, state, turned_motor = (np.zeros_like(motor) for _ in range(5))
    speeds, currents = [motor], []
    for k in range(voltage.shape[2]):
        time = begin_s + k * h
        state = _held(state, voltage[..., k], lag, h)
        drive = motors.constant * motors.current_A(state, motor) - motors.ripple_N_m(turned_motor)

        def pushed(speed: Array, drive: Array, share: float, inertia: Array, time: Array = time) -> Array:
            """Acceleration of one side, or of both, by a torque and its share of the friction."""
            direction = np.where(speed == 0.0, np.sign(drive), np.sign(speed))
            dry = share * motors.friction_N_m(direction, speed, time)
            surplus = direction * drive - share * motors.viscous * np.abs(speed) - dry
            return direction * np.where((speed == 0.0) & (surplus <= 0.0), 0.0, surplus) / inertia

        # Half a step of the back-EMF's own decay makes these the accelerations in mid-step.
        damped = motors.constant**2 / motors.resistance + motors.viscous
        alone_motor = pushed(motor, drive, shares[1], inertia_motor) / (1.0 + 0.5 * h * damped / inertia_motor)
        alone_load = pushed(load, np.zeros_like(drive), 1.0 - shares[1], inertia_load)
        together = pushed(motor, drive, 1.0, motors.inertia) / (1.0 + 0.5 * h * damped / motors.inertia)
        touches = (side != 0.0) & (side * (alone_motor - alone_load) >= 0.0)
        new_motor = _stopped(motor, motor + h * np.where(touches, together, alone_motor))
        new_load = np.where(touches, new_motor, _stopped(load, load + h * alone_load))
        turned = np.where(touches, 0.0, 0.5 * h * (motor + new_motor - load - new_load))
        new_angle = angle + turned
        side = np.where(touches, side, 0.0)
        outward = np.sign(new_angle)
        meets = ~touches & (np.abs(new_angle) >= 0.5 * gap) & (outward * (new_motor - new_load) > 0.0)
        angle = np.clip(new_angle, -0.5 * gap, 0.5 * gap)
        if meets.any():
            part = np.clip(1.0 + (angle - new_angle) / np.where(meets, turned, 1.0), 0.0, 1.0)
            met_motor, met_load = motor + part * (new_motor - motor), load + part * (new_load - load)
            shared = shares[0] * met_motor + (1.0 - shares[0]) * met_load
            onward = shared + (1.0 - part) * h * pushed(shared, drive, 1.0, motors.inertia)
            new_motor, new_load = np.where(meets, onward, new_motor), np.where(meets, onward, new_load)
            side = np.where(meets, outward, side)
        turned_motor = turned_motor + 0.5 * h * (motor + new_motor)
        motor, load = new_motor, new_load
        speeds.append(motor)
        currents.append(motors.current_A(state, motor))
    return np.stack(currents, axis=-1), np.stack(speeds, axis=-1)


def _stopped(before: Array, after: Array) -> Array:
    """Rest for a step where the speed changes its sign."""
    return np.where(before * after < 0.0, 0.0, after)
