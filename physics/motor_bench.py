"""One motor on a bench with everything that a robot's terms do to it: steady states and step responses, without noise.

What the bench's own instruments make of current and speed is `sensors.instruments`.
"""

import numpy as np
from numpy.typing import NDArray

from physics.driveline import Driveline
from physics.finite import require_finite
from physics.motor_arrays import HeldDrive
from physics.robot_model import RobotModel
from physics.terms.base import Slot
from physics.two_mass import Load, TwoMass

Array = NDArray[np.float64]

BISECTIONS = 60
SUBSTEP_S = 5e-4
PLAY_SUBSTEP_S = 1e-4


def steady_states(model: RobotModel, voltage_V: Array, time_s: Array) -> tuple[Array, Array]:
    """Current [A] and speed [rad/s], (N,) each, reached from rest at these voltages, so long after switching on.

    Raises:
        ValueError: A voltage is no finite number.
    """
    require_finite(voltage_V, "voltage_V", ("trial",))
    driveline = Driveline.of_bench(model)
    time = time_s[:, None]
    command = voltage_V[:, None]
    _, voltage = driveline.voltage_V(command, command, time, np.inf)
    sign = np.sign(voltage)

    def surplus_N_m(speed: Array) -> Array:
        drive = driveline.torque_constant_N_m_A * driveline.current_A(voltage, speed)
        friction = driveline.friction_N_m(drive, speed, time)
        return sign * (drive - driveline.viscous_N_m_s_rad * speed) - friction

    rest = np.zeros_like(voltage)
    moves = surplus_N_m(rest) > 0.0
    low, high = rest, np.abs(voltage) / driveline.torque_constant_N_m_A
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        faster = surplus_N_m(sign * middle) > 0.0
        low, high = np.where(faster, middle, low), np.where(faster, high, middle)
    speed = np.where(moves, sign * 0.5 * (low + high), 0.0)
    return driveline.current_A(voltage, speed)[:, 0], speed[:, 0]


def step_responses(
    model: RobotModel, voltage_V: Array, row_s: float, begin_s: Array | None = None
) -> tuple[Array, Array]:
    """Current [A] and speed [rad/s] on the motor side of the gearbox at the end of each row, from rest.

    Args:
        model: The robot whose right motor is on the bench.
        voltage_V: (T, N), each held for the row that ends at its sample.
        row_s: Length of a row.
        begin_s: (N,), time of each trial's start since the motor was first switched on; 0 by default.

    Raises:
        ValueError: A voltage is no finite number.
    """
    require_finite(voltage_V, "voltage_V", ("row", "trial"))
    shaft = _Shaft(model)
    substeps = max(1, round(row_s / shaft.substep_s))
    duration = row_s / substeps
    begin = np.zeros((voltage_V.shape[1], 1)) if begin_s is None else begin_s[:, None]
    commands = np.repeat(voltage_V, substeps, axis=0)[..., None]
    delay = min(round(model.input_delay_s / duration), len(commands))
    commands = np.concatenate([np.zeros_like(commands[:delay]), commands[: len(commands) - delay]])
    held = rest = np.zeros_like(commands[0])
    state = TwoMass(rest, rest, rest)
    current, speed = np.zeros_like(voltage_V), np.zeros_like(voltage_V)
    for k, command in enumerate(commands):
        time = begin + k * duration
        held, voltage = shaft.driveline.voltage_V(held, command, time, duration)
        state = shaft.moved(voltage, state, time, duration)
        row, part = divmod(k + 1, substeps)
        if part == 0:
            current[row - 1] = shaft.driveline.current_A(voltage, state.motor_rad_s)[:, 0]
            speed[row - 1] = state.motor_rad_s[:, 0]
    return current, speed


class _Shaft:
    """Rotor and gearbox, as one mass or as two with play between them."""

    def __init__(self, model: RobotModel) -> None:
        self.driveline = Driveline.of_bench(model)
        self._config = model.config.motor
        self._play = model.effects(Slot.GEARBOX) if model.has_play else ()
        self.substep_s = PLAY_SUBSTEP_S if model.has_play else SUBSTEP_S

    def moved(self, voltage: Array, state: TwoMass, time_s: Array, duration_s: float) -> TwoMass:
        driveline, speed = self.driveline, state.motor_rad_s
        torque = driveline.stall_torque_N_m(voltage) + driveline.extra_torque_N_m(voltage, speed)
        friction = driveline.friction_N_m(torque, speed, time_s)
        if not self._play:
            held = HeldDrive(torque, driveline.damping_N_m_s_rad, friction, driveline.inertia_kg_m2)
            rigid, _ = held.step(speed, duration_s)
            return TwoMass(rigid, rigid, state.slack_rad)
        part, inertia = self._config.motor_side_friction_fraction, self._config.motor_side_inertia_fraction
        viscous, whole = driveline.viscous_N_m_s_rad, driveline.inertia_kg_m2
        winding = driveline.damping_N_m_s_rad - viscous
        of_load = (1.0 - part) * driveline.friction_N_m(torque, state.load_rad_s, time_s)
        motor_side = Load(torque, winding + part * viscous, part * friction, inertia * whole)
        load_side = Load(np.zeros_like(torque), (1.0 - part) * viscous, of_load, (1.0 - inertia) * whole)
        for play in self._play:
            state = play(state, motor_side, load_side, duration_s)
        return state
