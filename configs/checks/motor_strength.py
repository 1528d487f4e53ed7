"""Motors that are too strong for the body and for the length of the steps of the simulation."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from configs.schema.robot import RobotConfig
from configs.schema.scenario import MAX_PHYSICS_HZ, Rates
from configs.validation.faults import ConfigFault
from symolo.core.yaml.tree import FieldPath

PROBLEM = "the motors are too strong for a body of this mass and for steps of this length"
CHECK = "check the motor's parameters, which are those at the wheel shaft"


@dataclass(frozen=True)
class OtherUnit:
    """Unit in which a parameter of a motor may have been written, and the numbers beyond which that is probable."""

    name: str
    factor: float
    """Factor to the unit of the field."""
    low: float
    high: float


PARAMETERS = {
    "torque_constant_N_m_A": OtherUnit("mN m/A", 0.001, 0.0, 10.0),
    "winding_resistance_ohm": OtherUnit("kohm", 1000.0, 0.05, math.inf),
    "viscous_friction_N_m_s_rad": OtherUnit("mN m s/rad", 0.001, 0.0, 0.5),
}
BODY = (("chassis", "mass_kg"), ("chassis", "length_m"), ("chassis", "base_height_m"), ("chassis", "clearance_m"))


def strength_faults(rates: Rates, robot: RobotConfig) -> Iterator[ConfigFault]:
    """Yield a fault if back-EMF and viscous friction of both motors stop the pitching body within a step.

    The engine computes these torques from the speeds before a step, and body and wheels would overshoot more at each
    step. Light wheels are no fault: `physics.bullet.body` limits how fast they settle.
    """
    step_s, settles_s = 1.0 / rates.physics_hz, _settles_s(robot)
    if settles_s > step_s:
        return
    motor = robot.motor
    allowed = (
        f"values with which the motors need more than a physics step of {1000.0 * step_s:.3g} ms to stop the pitching "
        f"of the body; they need {1000.0 * settles_s:.3g} ms, its inertia over 2 (K^2 / R + B) with K"
        f" {motor.torque_constant_N_m_A:.3g}, R {motor.winding_resistance_ohm:.3g} and B"
        f" {motor.viscous_friction_N_m_s_rad:.3g}"
    )
    hz = rates.physics_hz * (math.floor(step_s / settles_s) + 1)
    finer = f", or set rates.physics_hz to {hz}" if hz <= MAX_PHYSICS_HZ else ""
    by_motor = [
        ConfigFault(
            ("robot", "motor", name),
            PROBLEM,
            getattr(motor, name),
            allowed,
            cure=_unit(rates, robot, name) or CHECK + finer,
        )
        for name in PARAMETERS
    ]
    if motor.viscous_friction_N_m_s_rad > motor.torque_constant_N_m_A**2 / motor.winding_resistance_ohm:
        by_motor.reverse()
    others: list[FieldPath] = [("robot", *place) for place in BODY]
    got = [getattr(getattr(robot, section), name) for section, name in BODY]
    by_body = [
        ConfigFault(path, PROBLEM, value, allowed, cure=CHECK + finer) for path, value in zip(others, got, strict=True)
    ]
    by_rate = ConfigFault(("rates", "physics_hz"), PROBLEM, rates.physics_hz, allowed, cure=CHECK + finer)
    yield replace(by_motor[0], alternatives=(*by_motor[1:], *by_body, by_rate))


def _settles_s(robot: RobotConfig) -> float:
    """Return the time in which the motors stop the pitching of the body [s]."""
    motor, chassis = robot.motor, robot.chassis
    height_m = chassis.base_height_m - chassis.clearance_m
    pitch_kg_m2 = chassis.mass_kg / 12.0 * (chassis.length_m**2 + height_m**2)
    damping = motor.torque_constant_N_m_A**2 / motor.winding_resistance_ohm + motor.viscous_friction_N_m_s_rad
    return pitch_kg_m2 / (2.0 * damping)


def _unit(rates: Rates, robot: RobotConfig, name: str) -> str:
    """Return what to write if a parameter is in another unit; empty if its number is usual or the other impossible."""
    value, unit = getattr(robot.motor, name), PARAMETERS[name]
    motor = robot.motor.model_copy(update={name: value * unit.factor})
    possible = _settles_s(robot.model_copy(update={"motor": motor})) > 1.0 / rates.physics_hz
    if unit.low <= value <= unit.high or not possible:
        return ""
    return f"if it is in {unit.name}, write {value * unit.factor:.6g}; otherwise {CHECK}"
