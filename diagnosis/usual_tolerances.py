"""How far a robot may be from its nominal parameters where nobody stated it.

Shares of the nominal value, one standard deviation between units: those of small brushed gear motors and of printed or
laser-cut bodies with rubber tyres. A source that knows better says so in its nominal.yaml.
"""

from collections.abc import Mapping
from functools import partial

from configs.schema.robot import RobotConfig
from diagnosis.measured.nominal import KnownWheels, NominalRobot, PositiveSpread, Spread
from diagnosis.nuisances import UNITS, Nuisance, Number

SHARES: Mapping[str, float] = {
    "winding_resistance_ohm": 0.05,
    "torque_constant_N_m_A": 0.05,
    "viscous_friction_N_m_s_rad": 0.25,
    "coulomb_friction_N_m": 0.15,
    "rotor_inertia_kg_m2": 0.10,
}
WHEEL_SHARE = 0.006
"""Of a radius: half a millimetre of a diameter of some centimetres, to which a rubber tyre is measured."""
PAIR_SHARE = 0.003
"""Of the mean radius, by which two wheels of one make differ: rubber yields, and one side carries more (as below)."""
TRACK_SHARE = 0.01
"""Of the wheel separation: a tyre touches the floor along a line, and where on it the wheel turns about nobody knows
(Borenstein and Feng, IEEE Trans. Robotics and Automation 12 (1996) 869-880)."""


def usual(robot: RobotConfig) -> tuple[Nuisance, ...]:
    """Of the motor."""
    values = {name: float(getattr(robot.motor, name)) for name in SHARES}
    return tuple(
        Nuisance(name, value, SHARES[name] * value, _unit(name), partial(_motor, name))
        for name, value in values.items()
    )


def usual_wheels(*, diameter_m: float, track_m: float, counts_per_turn: float) -> KnownWheels:
    """Of a driven robot of which its drawing alone is known."""
    radius_m = 0.5 * diameter_m
    return KnownWheels(
        robot=NominalRobot(
            wheel_radius_m=PositiveSpread(value=radius_m, tolerance=WHEEL_SHARE * radius_m),
            wheel_separation_m=PositiveSpread(value=track_m, tolerance=TRACK_SHARE * track_m),
            encoder_ticks_per_revolution=counts_per_turn,
        ),
        wheel_radius_asymmetry=Spread(value=0.0, tolerance=PAIR_SHARE),
    )


def _unit(name: str) -> str:
    return next(unit for end, unit in UNITS.items() if name.endswith(f"_{end}"))


def _motor(name: str, robot: RobotConfig, value: Number) -> RobotConfig:
    return robot.model_copy(update={"motor": robot.motor.model_copy(update={name: value})})
