"""Where the electrical work goes: heat of winding and friction, and the rotor's kinetic energy.

Measured on the exact step that twin and motor bench share, without those effects whose losses lie elsewhere.
"""

from dataclasses import dataclass

import numpy as np

from diagnosis.validation.motor.steps import ROWS_PER_TIME_CONSTANT, time_constant_s
from physics.drivetrain.motor import MotorModel
from physics.drivetrain.motor_arrays import HeldDrive
from symolo.core.arrays import Array

PROGRAMME = ((1.0, 8), (0.0, 4), (-0.5, 8), (1.0, 8), (0.0, 4))
"""Share of the highest voltage, and for how many time constants: run, brake, reverse, plug, brake to a stop."""


@dataclass(frozen=True)
class EnergyBench:
    """Sums from the start to the end of each row, (N,)."""

    time_s: tuple[float, ...]
    voltage_V: tuple[float, ...]
    speed_rad_s: tuple[float, ...]
    electrical_J: tuple[float, ...]
    """Integral of u i."""
    winding_J: tuple[float, ...]
    """Integral of R i^2."""
    friction_J: tuple[float, ...]
    """Integral of Tq |w| + B w^2."""
    kinetic_J: tuple[float, ...]
    """J w^2 / 2."""
    throughput_J: float
    """Electrical work in either direction, which the imbalance is compared with."""
    largest_imbalance_J: float
    """Largest of electrical work less heat and kinetic energy, at any time."""
    min_friction_heat_J: float
    """In any row: never below zero."""


def energy_bench(motor: MotorModel, voltage_limit_V: float) -> EnergyBench:
    """Run the programme from rest on a motor off load."""
    constant_s = time_constant_s(motor)
    row_s = constant_s / ROWS_PER_TIME_CONSTANT
    share, lasts = np.array(PROGRAMME).T
    voltage = voltage_limit_V * np.repeat(share, (lasts * ROWS_PER_TIME_CONSTANT).astype(int))
    speed, half, angle = _driven(motor, voltage, row_s)
    # Simpson's rule, for within a row the speed is exponential; the angle is exact as it comes.
    squared = row_s / 6.0 * (speed[:-1] ** 2 + 4.0 * half**2 + speed[1:] ** 2)
    resistance, constant = motor.resistance_ohm, motor.torque_constant_N_m_A
    electrical = voltage * (voltage * row_s - constant * angle) / resistance
    winding = (voltage**2 * row_s - 2.0 * voltage * constant * angle + constant**2 * squared) / resistance
    travelled = row_s / 6.0 * (np.abs(speed[:-1]) + 4.0 * np.abs(half) + np.abs(speed[1:]))
    friction = motor.coulomb_N_m * travelled + motor.viscous_N_m_s_rad * squared
    kinetic = 0.5 * motor.inertia_kg_m2 * speed[1:] ** 2
    balance = np.cumsum(electrical - winding - friction) - kinetic
    return EnergyBench(
        time_s=tuple((row_s * np.arange(1, len(voltage) + 1)).tolist()),
        voltage_V=tuple(voltage.tolist()),
        speed_rad_s=tuple(speed[1:].tolist()),
        electrical_J=tuple(np.cumsum(electrical).tolist()),
        winding_J=tuple(np.cumsum(winding).tolist()),
        friction_J=tuple(np.cumsum(friction).tolist()),
        kinetic_J=tuple(kinetic.tolist()),
        throughput_J=float(np.abs(electrical).sum()),
        largest_imbalance_J=float(np.abs(balance).max()),
        min_friction_heat_J=float(friction.min()),
    )


def _driven(motor: MotorModel, voltage: Array, row_s: float) -> tuple[Array, Array, Array]:
    """Speed at the start and after each row (N + 1,), halfway through it (N,), and angle turned in it (N,)."""
    speed, half, angle = np.zeros(len(voltage) + 1), np.zeros(len(voltage)), np.zeros(len(voltage))
    for k, held_V in enumerate(voltage.tolist()):
        drive = HeldDrive(
            np.array([motor.stall_torque_N_m(held_V)]),
            np.array([motor.damping_N_m_s_rad]),
            np.array([motor.coulomb_N_m]),
            np.array([motor.inertia_kg_m2]),
        )
        half[k] = drive.step(speed[k : k + 1], 0.5 * row_s)[0][0]
        after, turned = drive.step(speed[k : k + 1], row_s)
        speed[k + 1], angle[k] = after[0], turned[0]
    return speed, half, angle
