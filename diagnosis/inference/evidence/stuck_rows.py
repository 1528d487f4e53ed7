"""Rows of a motor bench in which the wheel stood still though the nominal motor turns.

They say nothing of a running motor and are left out of every fit (`stages.motor_steady`), but they bound the friction
that holds a wheel at rest: it is at least the torque of the largest stuck row, and below what the smallest row that
moves would have had at standstill. At standstill there is no back-EMF, so that voltage over current is the resistance
of winding, bridge and leads together.
"""

from dataclasses import dataclass

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.measured.measurement import Measurement
from diagnosis.predictors.rows import given
from physics.drivetrain.motor_bench import steady_states
from physics.robot.model import RobotModel


@dataclass(frozen=True)
class StuckRow:
    row: int
    """From 1."""
    voltage_V: float
    current_A: float
    """NaN where it was not logged."""
    nominal_speed_rad_s: float
    """At which the nominal motor would turn."""
    holds_N_m: float
    """Torque of the motor at standstill, which friction holds: by the current, else by voltage and resistance."""
    resistance_ohm: float
    """Voltage over current; NaN without one."""
    moves_at_V: float | None
    """The smallest voltage of the same sign at which the wheel moves; None if it never does."""
    moves_N_m: float | None
    """Torque that the motor would have there at standstill, which is enough to move it."""


def stuck_rows(measurement: Measurement, nominal: RobotConfig) -> tuple[StuckRow, ...]:
    """Of a bench with voltages and speeds, in the order of its rows; currents where it has them.

    Args:
        measurement: Of kind motor_steady.
        nominal: The robot whose motor is on the bench, with its nominal parameters.
    """
    voltage_V, speed, current_A = (given(measurement, name) for name in ("u_cmd_V", "omega_rad_s", "current_A"))
    known = np.isfinite(voltage_V) & np.isfinite(speed)
    expected = np.zeros_like(voltage_V)
    model = RobotModel.from_config(nominal)
    _, expected[known] = steady_states(model, voltage_V[known], np.zeros(int(known.sum())))
    constant = nominal.motor.torque_constant_N_m_A
    stuck = known & (voltage_V != 0.0) & (speed == 0.0) & (expected != 0.0)
    found = []
    for i in np.flatnonzero(stuck).tolist():
        volts = float(voltage_V[i])
        has_current = bool(np.isfinite(current_A[i])) and current_A[i] != 0.0
        resistance = volts / float(current_A[i]) if has_current else float("nan")
        ohm = resistance if has_current else nominal.motor.winding_resistance_ohm
        moving = known & (speed != 0.0) & (np.sign(voltage_V) == np.sign(volts))
        moves_V = float(np.abs(voltage_V[moving]).min()) if moving.any() else None
        found.append(
            StuckRow(
                row=i + 1,
                voltage_V=volts,
                current_A=float(current_A[i]),
                nominal_speed_rad_s=float(expected[i]),
                holds_N_m=constant * abs(volts) / ohm,
                resistance_ohm=resistance,
                moves_at_V=moves_V,
                moves_N_m=None if moves_V is None else constant * moves_V / ohm,
            )
        )
    return tuple(found)
