"""Rows of a motor bench in which the wheel stands still although the nominal motor turns.

They contain nothing about a running motor and are left out of every fit (`predictors.motor.steady`), but they bound the
friction of a wheel at rest: it is at least the torque of the largest row at standstill, and less than the torque that
the smallest row in motion would have had at standstill. At standstill there is no back-EMF, so voltage over current is
the resistance of winding, bridge and leads together.
"""

from dataclasses import dataclass

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.measured.measurement import Measurement
from diagnosis.predictors.rows import good_values
from physics.drivetrain.motor_bench import steady_states
from physics.robot.model import RobotModel


@dataclass(frozen=True)
class StuckRow:
    """One row at standstill."""

    row: int
    """Number of the row, from 1."""
    voltage_V: float
    current_A: float
    """Measured current; NaN if it was not logged."""
    nominal_speed_rad_s: float
    """Speed at which the nominal motor would turn."""
    holds_N_m: float
    """Torque of the motor at standstill, which friction holds: from the current, else from voltage and resistance."""
    resistance_ohm: float
    """Voltage over current; NaN without a current."""
    moves_at_V: float | None
    """The smallest voltage of the same sign at which the wheel moves; None if it never does."""
    moves_N_m: float | None
    """Torque at standstill for the voltage `moves_at_V`, which is enough to move the wheel; None if it never moves."""


def stuck_rows(measurement: Measurement, nominal: RobotConfig) -> tuple[StuckRow, ...]:
    """Return the rows at standstill of a bench with voltages and speeds, and currents if it has them, in their order.

    Args:
        measurement: A measurement of kind motor_steady.
        nominal: The robot whose motor is on the bench, with its nominal parameters.
    """
    voltage_V, speed, current_A = (good_values(measurement, name) for name in ("u_cmd_V", "omega_rad_s", "current_A"))
    known = np.isfinite(voltage_V) & np.isfinite(speed)
    expected = np.zeros_like(voltage_V)
    model = RobotModel.from_config(nominal)
    _, expected[known] = steady_states(model, voltage_V[known], np.zeros(int(known.sum())))
    constant = nominal.motor.torque_constant_N_m_A
    stuck = known & (voltage_V != 0.0) & (speed == 0.0) & (expected != 0.0)
    rows = []
    for i in np.flatnonzero(stuck).tolist():
        volts = float(voltage_V[i])
        has_current = bool(np.isfinite(current_A[i])) and current_A[i] != 0.0
        resistance = volts / float(current_A[i]) if has_current else float("nan")
        ohm = resistance if has_current else nominal.motor.winding_resistance_ohm
        moving = known & (speed != 0.0) & (np.sign(voltage_V) == np.sign(volts))
        moves_V = float(np.abs(voltage_V[moving]).min()) if moving.any() else None
        rows.append(
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
    return tuple(rows)
