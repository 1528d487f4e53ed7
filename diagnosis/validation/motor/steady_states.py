"""Steady states of a motor beside the measured ones of the paper's Table 1 (the paper's Fig. 10)."""

from collections.abc import Callable
from dataclasses import astuple, dataclass

import numpy as np

from diagnosis.motor_identification import (
    TABLE_1,
    TABLE_2,
    MotorParameters,
    SteadyStates,
    identify,
    identify_as_printed,
)
from physics.drivetrain.motor import MotorModel
from physics.drivetrain.motor_bench import steady_states
from physics.robot.model import RobotModel
from symolo.core.arrays import Array

CURVE_POINTS = 201


@dataclass(frozen=True)
class Residuals:
    """Model less measurement."""

    by_row: tuple[float, ...]
    rms: float
    largest: float
    """By size, with its sign."""

    @classmethod
    def of(cls, model: Array, measured: Array) -> "Residuals":
        by_row = model - measured
        return cls(
            by_row=tuple(by_row.tolist()),
            rms=float(np.sqrt(np.mean(by_row**2))),
            largest=float(by_row[np.argmax(np.abs(by_row))]),
        )


@dataclass(frozen=True)
class Curve:
    """A motor over a fine row of voltages."""

    voltage_V: tuple[float, ...]
    current_A: tuple[float, ...]
    speed_rad_s: tuple[float, ...]


@dataclass(frozen=True)
class Candidate:
    """A motor model beside the measurement; what belongs to a row of the table is at the table's voltages."""

    name: str
    parameters: MotorParameters
    """Of the robot: with its effects that scale them; others may act beside them."""
    current_A: tuple[float, ...]
    speed_rad_s: tuple[float, ...]
    current_residual_A: Residuals
    speed_residual_rad_s: Residuals
    curve: Curve


@dataclass(frozen=True)
class SteadyBench:
    voltage_V: tuple[float, ...]
    """Table 1, as are the next two."""
    measured_current_A: tuple[float, ...]
    measured_speed_rad_s: tuple[float, ...]
    robot: Candidate
    literal_fit: Candidate
    """Eq. 21-22 on all rows of Table 1."""
    printed_variant: Candidate
    """The fit that rounds to Table 2: an intercept beside R and K, no row of 0 V for B and Tq."""
    table_2: Candidate
    """The printed, rounded values themselves."""


def steady_bench(model: RobotModel, table: SteadyStates = TABLE_1) -> SteadyBench:
    """Steady states of the robot's right motor, from rest and off load, and of the three sets of parameters."""

    def states_of_robot(voltage_V: Array) -> tuple[Array, Array]:
        return steady_states(model, voltage_V, np.zeros_like(voltage_V))

    return SteadyBench(
        voltage_V=tuple(table.voltage_V.tolist()),
        measured_current_A=tuple(table.current_A.tolist()),
        measured_speed_rad_s=tuple(table.speed_rad_s.tolist()),
        robot=_candidate(f"robot {model.config.name}", _parameters(model.motors.right), states_of_robot, table),
        literal_fit=_fitted("literal fit of Eq. 21-22", identify(table), table),
        printed_variant=_fitted("variant giving Table 2", identify_as_printed(table), table),
        table_2=_fitted("Table 2 as printed", TABLE_2, table),
    )


def _fitted(name: str, parameters: MotorParameters, table: SteadyStates) -> Candidate:
    motor = MotorModel(*astuple(parameters), inertia_kg_m2=0.0)

    def states(voltage_V: Array) -> tuple[Array, Array]:
        rows = np.array([motor.steady_state(voltage) for voltage in voltage_V.tolist()])
        return rows[:, 0], rows[:, 1]

    return _candidate(name, parameters, states, table)


def _parameters(motor: MotorModel) -> MotorParameters:
    return MotorParameters(
        winding_resistance_ohm=motor.resistance_ohm,
        torque_constant_N_m_A=motor.torque_constant_N_m_A,
        viscous_friction_N_m_s_rad=motor.viscous_N_m_s_rad,
        coulomb_friction_N_m=motor.coulomb_N_m,
    )


def _candidate(
    name: str,
    parameters: MotorParameters,
    states: Callable[[Array], tuple[Array, Array]],
    table: SteadyStates,
) -> Candidate:
    current, speed = states(table.voltage_V)
    fine = np.linspace(table.voltage_V.min(), table.voltage_V.max(), CURVE_POINTS)
    fine_current, fine_speed = states(fine)
    return Candidate(
        name=name,
        parameters=parameters,
        current_A=tuple(current.tolist()),
        speed_rad_s=tuple(speed.tolist()),
        current_residual_A=Residuals.of(current, table.current_A),
        speed_residual_rad_s=Residuals.of(speed, table.speed_rad_s),
        curve=Curve(tuple(fine.tolist()), tuple(fine_current.tolist()), tuple(fine_speed.tolist())),
    )
