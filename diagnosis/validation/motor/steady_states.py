"""Steady states of the motor compared with the measured ones of the paper's Table 1 (the paper's Fig. 10)."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, astuple, dataclass

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.motor_identification import (
    TABLE_1,
    TABLE_2,
    MotorParameters,
    identify,
    identify_as_printed,
)
from diagnosis.validation.experiment import ExperimentResult
from diagnosis.validation.measures import rms
from diagnosis.validation.panels import Curve, Panel
from physics.drivetrain import motor_bench
from physics.drivetrain.motor import MotorModel
from physics.robot.model import RobotModel
from symolo.core.arrays import Array
from symolo.pages.plotting import BLACK, BLUE, GREEN, ORANGE, VERMILION

CURVE_POINTS = 201


@dataclass(frozen=True)
class MotorCandidate:
    """A motor model that is compared with Table 1."""

    name: str
    parameters: MotorParameters
    """Parameters of the motor; those of the robot include the effects that scale them."""
    states: Callable[[Array], tuple[Array, Array]]
    """Function from voltages to currents [A] and speeds [rad/s], (N,) each."""
    color: str
    style: str
    width: float
    """Width of its line in the figure [points]."""


def steady_states(robot: RobotConfig, _seed: int) -> ExperimentResult:
    """Return steady states of the right motor, from rest and without load, and of three sets of parameters."""
    voltage = TABLE_1.voltage_V
    fine = np.linspace(voltage.min(), voltage.max(), CURVE_POINTS)
    candidates = _candidates(robot)
    tables = {"table_1": vars(TABLE_1)}
    notes = []
    for candidate in candidates:
        current, speed = candidate.states(voltage)
        fine_current, fine_speed = candidate.states(fine)
        current_residual, speed_residual = current - TABLE_1.current_A, speed - TABLE_1.speed_rad_s
        table = asdict(candidate.parameters) | {
            "current_A": current,
            "speed_rad_s": speed,
            "current_residual_A": current_residual,
            "current_residual_rms_A": rms(current_residual),
            "largest_current_residual_A": largest(current_residual),
            "speed_residual_rad_s": speed_residual,
            "speed_residual_rms_rad_s": rms(speed_residual),
            "largest_speed_residual_rad_s": largest(speed_residual),
            "curve_voltage_V": fine,
            "curve_current_A": fine_current,
            "curve_speed_rad_s": fine_speed,
        }
        tables[candidate.name] = table
        r, k, b, tq = astuple(candidate.parameters)
        notes.append(
            f"{candidate.name} (R {r:.4f} ohm, K {k:.4f} N m/A, B {b:.5f} N m s, Tq {tq:.4f} N m) minus Table 1: "
            f"speed {rms(speed_residual):.3f} rad/s rms, {largest(speed_residual):+.3f} at worst; "
            f"current {1e3 * rms(current_residual):.2f} mA rms, {1e3 * largest(current_residual):+.2f} at worst"
        )
    return ExperimentResult(tables, panels=_panels(candidates, tables), notes=notes)


def _candidates(robot: RobotConfig) -> tuple[MotorCandidate, ...]:
    model = RobotModel.from_config(robot)
    motor = model.motors.right
    parameters = MotorParameters(
        motor.resistance_ohm, motor.torque_constant_N_m_A, motor.viscous_N_m_s_rad, motor.coulomb_N_m
    )

    def states_of_robot(voltage_V: Array) -> tuple[Array, Array]:
        return motor_bench.steady_states(model, voltage_V, np.zeros_like(voltage_V))

    fitted, printed = identify(TABLE_1), identify_as_printed(TABLE_1)
    # The literal fit is drawn first and wide, because the motor of the nominal robot lies exactly on it.
    return (
        MotorCandidate("fit of Eq. 21-22 as written", fitted, _states(fitted), ORANGE, "-", 3.5),
        MotorCandidate("robot", parameters, states_of_robot, BLUE, "-", 1.5),
        MotorCandidate("variant that gives Table 2", printed, _states(printed), VERMILION, "--", 1.5),
        MotorCandidate("Table 2 as printed", TABLE_2, _states(TABLE_2), GREEN, ":", 1.5),
    )


def _states(parameters: MotorParameters) -> Callable[[Array], tuple[Array, Array]]:
    motor = MotorModel(*astuple(parameters), inertia_kg_m2=0.0)

    def states(voltage_V: Array) -> tuple[Array, Array]:
        rows = np.array([motor.steady_state(voltage) for voltage in voltage_V.tolist()])
        return rows[:, 0], rows[:, 1]

    return states


def largest(residuals: Array) -> float:
    """Return the residual of the largest magnitude, with its sign."""
    return float(residuals[np.argmax(np.abs(residuals))])


def _panels(candidates: Sequence[MotorCandidate], tables: dict) -> list[Panel]:
    panels = []
    for what, name, unit, scale in (("Speed", "speed_rad_s", "rad/s", 1.0), ("Current", "current_A", "mA", 1e3)):
        residual = name.replace("_", "_residual_", 1)
        curves, residuals, voltage = [], [], TABLE_1.voltage_V
        for c in candidates:
            table = tables[c.name]
            curve = scale * table[f"curve_{name}"]
            curves.append(Curve(table["curve_voltage_V"], curve, c.name, c.color, c.style, c.width))
            residuals.append(Curve(voltage, scale * table[residual], c.name, c.color, f"o{c.style}", c.width, size=4))
        curves.append(Curve(voltage, scale * tables["table_1"][name], "measured (Table 1)", BLACK, "o", size=4))
        panels.append(Panel(f"{what} in the steady state", "voltage [V]", f"{what.lower()} [{unit}]", curves))
        panels.append(
            Panel(f"{what}: model minus Table 1", "voltage [V]", f"difference [{unit}]", residuals, y_lines=[0.0])
        )
    return panels
