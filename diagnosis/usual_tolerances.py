"""How far a robot may be from its nominal parameters where nobody stated it.

Shares of the nominal value, one standard deviation between units: those of small brushed gear motors and of printed or
laser-cut bodies with rubber tyres. A source that knows better says so in its nominal.yaml.
"""

from functools import partial

from configs.schema.robot import RobotConfig
from diagnosis.nuisances import UNITS, Nuisance, Number

SHARES = {
    "winding_resistance_ohm": 0.05,
    "torque_constant_N_m_A": 0.05,
    "viscous_friction_N_m_s_rad": 0.25,
    "coulomb_friction_N_m": 0.15,
    "rotor_inertia_kg_m2": 0.10,
}


def usual(robot: RobotConfig) -> tuple[Nuisance, ...]:
    """Of the motor."""
    values = {name: float(getattr(robot.motor, name)) for name in SHARES}
    return tuple(
        Nuisance(name, value, SHARES[name] * value, _unit(name), partial(_motor, name))
        for name, value in values.items()
    )


def _unit(name: str) -> str:
    return next(unit for end, unit in UNITS.items() if name.endswith(f"_{end}"))


def _motor(name: str, robot: RobotConfig, value: Number) -> RobotConfig:
    return robot.model_copy(update={"motor": robot.motor.model_copy(update={name: value})})
