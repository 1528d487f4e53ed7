"""Balance of electrical work, heat of winding and friction, and kinetic energy of the rotor.

It is computed for the exact step that the fast twin uses too, without effects, since some of them have other losses.
"""

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.validation.experiment import ExperimentResult, ValidationCheck
from diagnosis.validation.motor.steps import ROWS_PER_TIME_CONSTANT, time_constant_s
from diagnosis.validation.panels import Curve, Panel
from physics.drivetrain.motor import MotorModel
from physics.drivetrain.motor_arrays import HeldDrive
from physics.drivetrain.wheel_loop import voltage_limit_V
from physics.robot.model import RobotModel
from symolo.core.arrays import Array
from symolo.pages.plotting import BLACK, BLUE, ORANGE, SKY

PROGRAMME = ((1.0, 8), (0.0, 4), (-0.5, 8), (1.0, 8), (0.0, 4))
"""Shares of the highest voltage with their durations in time constants: run, brake, reverse, plug, brake to a stop."""
MAX_IMBALANCE = 1e-6
"""Largest imbalance, as a share of the electrical work."""


def energy(robot: RobotConfig, _seed: int) -> ExperimentResult:
    """Return the sums of work and heat over the programme, from rest, for the right motor without load."""
    motor = RobotModel.from_config(robot).motors.right
    row_s = time_constant_s(motor) / ROWS_PER_TIME_CONSTANT
    share, lasts = np.array(PROGRAMME).T
    voltage = voltage_limit_V(robot.power) * np.repeat(share, (lasts * ROWS_PER_TIME_CONSTANT).astype(int))
    speed, half, angle = _driven(motor, voltage, row_s)
    # Simpson's rule integrates the squared speed, which is exponential within a row; the angle itself is exact.
    squared = row_s / 6.0 * (speed[:-1] ** 2 + 4.0 * half**2 + speed[1:] ** 2)
    resistance, constant = motor.resistance_ohm, motor.torque_constant_N_m_A
    electrical = voltage * (voltage * row_s - constant * angle) / resistance
    winding = (voltage**2 * row_s - 2.0 * voltage * constant * angle + constant**2 * squared) / resistance
    travelled = row_s / 6.0 * (np.abs(speed[:-1]) + 4.0 * np.abs(half) + np.abs(speed[1:]))
    friction = motor.coulomb_N_m * travelled + motor.viscous_N_m_s_rad * squared
    kinetic = 0.5 * motor.inertia_kg_m2 * speed[1:] ** 2
    imbalance_J = float(np.abs(np.cumsum(electrical - winding - friction) - kinetic).max())
    throughput_J = float(np.abs(electrical).sum())
    work, lost, rubbed = np.cumsum(electrical), np.cumsum(winding), np.cumsum(friction)
    time = row_s * np.arange(1, len(voltage) + 1)
    sums = {
        "time_s": time,
        "voltage_V": voltage,
        "speed_rad_s": speed[1:],
        "electrical_J": work,
        "winding_J": lost,
        "friction_J": rubbed,
        "kinetic_J": kinetic,
        "throughput_J": throughput_J,
        "lowest_friction_heat_of_a_row_J": float(friction.min()),
    }
    law = "conservation of energy"
    checks = (
        ValidationCheck("largest imbalance", imbalance_J, 0.0, MAX_IMBALANCE * throughput_J, law, "J"),
        ValidationCheck("rows with friction heat below zero", int((friction < 0.0).sum()), 0, 0, law),
    )
    heat = lost + rubbed
    curves = (
        Curve(1e3 * time, lost, "heat of the winding", ORANGE, kind="area"),
        Curve(1e3 * time, heat, "heat of friction", BLUE, kind="area", base=lost),
        Curve(1e3 * time, heat + kinetic, "kinetic energy", SKY, kind="area", base=heat),
        Curve(1e3 * time, work, "electrical work", BLACK, "--"),
    )
    panel = Panel("Energy: run, brake, reverse, plug, brake", "time [ms]", "sum from the start [J]", curves)
    return ExperimentResult({"sums": sums}, checks, (panel,))


def _driven(motor: MotorModel, voltage: Array, row_s: float) -> tuple[Array, Array, Array]:
    """Return speed at the start and after each row (N + 1,), halfway through it (N,), and angle turned in it (N,)."""
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
