"""What the inductance of a winding, which the simulator neglects, changes in steps of the voltage.

A current follows (u - K w) / R with a first-order lag of the time constant L / R, so that the inductance takes L dI/dt
of the voltage. This is in no list, and resembles a lag of the driver, which delays the voltage and not the back-EMF.
"""

from collections.abc import Callable

import numpy as np

from physics.drivetrain.first_order import lag_of_linear_input
from physics.drivetrain.motor import MotorModel
from symolo.core.arrays import Array

INDUCTANCE = "inductance of the winding"
"""What it is called in reports."""
TIME_CONSTANTS = tuple(np.geomspace(0.1, 8.0, 20).tolist())
"""Time constants that are tried, in samples."""
ROUNDS = 2
"""Number of times that motions and voltages are computed in turn. What is left is of the order of the square of the
electrical time constant relative to the mechanical one."""


def inductive_motions(
    motor: MotorModel, voltage_V: Array, period_s: float, motions: Callable[[Array], Array], nominal: Array
) -> Array:
    """Return currents [A] and speeds [rad/s] with an inductance, (k, 2, T, N), for each of k time constants.

    Args:
        motor: The nominal motor.
        voltage_V: (T, N), each held over the period that ends at its sample.
        period_s: Time between two samples.
        motions: Function that returns currents and speeds (k, 2, T, N) by voltages (T, k N).
        nominal: (2, T, N), current and speed of the nominal motor.
    """
    time_s = period_s * np.array(TIME_CONSTANTS)[:, None]
    speed = np.broadcast_to(nominal[1], (len(time_s), *nominal[1].shape))
    for _ in range(ROUNDS):
        driving_V = _lagged_V(motor, voltage_V, speed, period_s, time_s)
        # The mean of L dI/dt over a period, where R I is the lagged voltage.
        lost_V = time_s[:, None] * np.diff(driving_V, axis=1, prepend=0.0) / period_s
        left_V = np.moveaxis(voltage_V - lost_V, 0, 1)
        speed = motions(left_V.reshape(len(left_V), -1))[:, 1]
    current = _lagged_V(motor, voltage_V, speed, period_s, time_s) / motor.resistance_ohm
    return np.stack([current, speed], axis=1)


def _lagged_V(motor: MotorModel, voltage_V: Array, speed_rad_s: Array, period_s: float, time_s: Array) -> Array:
    """Return the lagged difference (k, T, N) of the voltage and the back-EMF, whose speeds (k, T, N) are at samples."""
    emf_V = motor.torque_constant_N_m_A * speed_rad_s
    lagged_V = np.zeros_like(emf_V)
    for row in range(1, len(voltage_V)):
        first_V, last_V = (voltage_V[row] - emf_V[:, k] for k in (row - 1, row))
        lagged_V[:, row] = lag_of_linear_input(lagged_V[:, row - 1], first_V, last_V, period_s, time_s)
    return lagged_V
