"""temporary"""

from collections.abc import Callable
from dataclasses import dataclass

from configs.schema.robot import RobotConfig
from diagnosis.measured.nominal import Nominal


@dataclass(frozen=True)
class Nuisance:
    name: str
    value: float
    tolerance: float
    applied: Callable[[RobotConfig, float], RobotConfig]


def _motor(key):
    return lambda robot, value: robot.model_copy(update={"motor": robot.motor.model_copy(update={key: value})})


def nuisances(nominal: Nominal) -> tuple[Nuisance, ...]:
    found = []
    for key in (
        "winding_resistance_ohm",
        "torque_constant_N_m_A",
        "viscous_friction_N_m_s_rad",
        "coulomb_friction_N_m",
        "rotor_inertia_kg_m2",
    ):
        spread = getattr(nominal.motor, key, None)
        if spread is not None:
            found.append(Nuisance(f"motor.{key}", spread.value, spread.tolerance, _motor(key)))
    return tuple(found)
