"""Motor parameters from steady-state measurements by least squares (paper Eq. 21 and 22, Tables 1 and 2).

The printed recipe, applied to all 21 rows of Table 1, gives values that do not all round to the printed Table 2;
`identify_as_printed` does. The nominal robot uses the unrounded results of the recipe, since Table 2 as printed, with
its viscous friction of 0.002, gives a current at 5 V that is 11 % too low.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from symolo.core.arrays import Array


@dataclass(frozen=True)
class SteadyStates:
    """Measurements in steady state, one row for each voltage, (N,) each."""

    voltage_V: Array
    current_A: Array
    speed_rad_s: Array

    @classmethod
    def from_rows(cls, rows: Sequence[tuple[float, float, float]]) -> "SteadyStates":
        """Return the states from rows of voltage, current and speed."""
        columns = np.array(rows).T
        columns.flags.writeable = False
        return cls(*columns)


@dataclass(frozen=True)
class MotorParameters:
    """Parameters at the wheel shaft, as in `configs.schema.robot.Motor`."""

    winding_resistance_ohm: float
    torque_constant_N_m_A: float
    viscous_friction_N_m_s_rad: float
    coulomb_friction_N_m: float


TABLE_1 = SteadyStates.from_rows(
    (
        (0.00, 0.000000, 0.00000),
        (0.25, 0.072723, 0.00000),
        (0.50, 0.072155, 0.87457),
        (0.75, 0.079350, 1.61743),
        (1.00, 0.085538, 2.42328),
        (1.25, 0.091426, 3.24140),
        (1.50, 0.094087, 3.96708),
        (1.75, 0.103298, 4.76475),
        (2.00, 0.109114, 5.45525),
        (2.25, 0.113620, 6.23410),
        (2.50, 0.117927, 7.11685),
        (2.75, 0.123966, 7.80653),
        (3.00, 0.131561, 8.55920),
        (3.25, 0.137696, 9.20634),
        (3.50, 0.144181, 9.99828),
        (3.75, 0.148593, 10.75750),
        (4.00, 0.151752, 11.48560),
        (4.25, 0.158205, 12.32090),
        (4.50, 0.166269, 12.89280),
        (4.75, 0.172286, 13.50970),
        (5.00, 0.178680, 14.31800),
    )
)
"""Paper Table 1."""

TABLE_2 = MotorParameters(3.03, 0.31, 0.002, 0.02)
"""Paper Table 2, as printed."""


def identify(table: SteadyStates) -> MotorParameters:
    """Return the result of the recipe: u = R i + K w for R and K, then K i = B w + Tq for B and Tq, on all rows."""
    resistance, constant = least_squares([table.current_A, table.speed_rad_s], table.voltage_V)
    return MotorParameters(resistance, constant, *_friction(table, constant))


def identify_as_printed(table: SteadyStates) -> MotorParameters:
    """Return Table 2: R and K with an intercept on all rows, B and Tq without the rows at 0 V."""
    one = np.ones_like(table.voltage_V)
    resistance, constant, _ = least_squares([table.current_A, table.speed_rad_s, one], table.voltage_V)
    driven = table.voltage_V != 0.0
    rows = SteadyStates(table.voltage_V[driven], table.current_A[driven], table.speed_rad_s[driven])
    return MotorParameters(resistance, constant, *_friction(rows, constant))


def _friction(table: SteadyStates, torque_constant: float) -> tuple[float, float]:
    one = np.ones_like(table.speed_rad_s)
    viscous, coulomb = least_squares([table.speed_rad_s, one], torque_constant * table.current_A)
    return viscous, coulomb


def least_squares(regressors: list[Array], target: Array) -> tuple[float, ...]:
    """Return (H^T H)^-1 H^T u of Eq. 22, with one column of H for each regressor."""
    H = np.stack(regressors, axis=1)
    return tuple(float(value) for value in np.linalg.solve(H.T @ H, H.T @ target))
