"""Usual tolerances of nominal parameters, if the source does not state them.

They are standard deviations between units, as shares of the nominal value, for small brushed gear motors and for
printed or laser-cut bodies with rubber tyres. A source can state better ones in its nominal.yaml.
"""

from collections.abc import Mapping

from configs.schema.robot import RobotConfig
from diagnosis.measured.case_files.nominal import KnownWheels, NominalLog, NominalRobot, PositiveSpread, Spread
from diagnosis.nuisances import Nuisance, Number, nuisances, section_nuisance

SHARES: Mapping[str, float] = {
    "winding_resistance_ohm": 0.05,
    "torque_constant_N_m_A": 0.05,
    "viscous_friction_N_m_s_rad": 0.25,
    "coulomb_friction_N_m": 0.15,
    "rotor_inertia_kg_m2": 0.10,
}
WHEEL_SHARE = 0.006
"""Tolerance of a radius: the diameter of a rubber tyre of some centimetres can be measured to half a millimetre."""
PAIR_SHARE = 0.003
"""Difference of two wheels of the same type, as a share of the mean radius: rubber yields, and one side carries more
weight (source: see below)."""
SPEED_AGE_S = 0.025
"""Age of a logged speed, beside that of a mean since the row before. A robot that logs the speed at the time of the row
differs from such a mean by half a row."""
BODY_SPEED_AGE_S = 0.005
"""Age of a speed of the body. It is that of its row, but an integral over rows of 50 ms is late or early by some
milliseconds, since the speed between two rows is not a straight line of time."""
TRACK_SHARE = 0.01
"""Tolerance of the wheel separation: a tyre touches the floor along a line, and the point on it about which the wheel
turns is not known (Borenstein and Feng, IEEE Trans. Robotics and Automation 12 (1996) 869-880)."""


def usual(robot: RobotConfig) -> tuple[Nuisance, ...]:
    """Return the nuisances of the motor of a robot."""
    values = {name: float(getattr(robot.motor, name)) for name in SHARES}
    return tuple(section_nuisance("motor", name, name, value, SHARES[name] * value) for name, value in values.items())


def usual_of_log(case: NominalLog) -> tuple[Nuisance, ...]:
    """Return the nuisances of a robot whose speeds were logged: of its wheels and of the age of the speeds; of the age
    alone for speeds of its body.
    """
    drive, encoder = case.robot.drive, case.robot.encoder
    wheels = usual_wheels(
        diameter_m=drive.wheel_diameter_m, track_m=drive.track_m, counts_per_turn=encoder.counts_per_revolution
    )

    def changed(robot: RobotConfig, value: Number) -> RobotConfig:
        return robot.with_section("encoder", {"delay_s": value})

    if case.twist == "truth":
        return (Nuisance("speed_age_s", encoder.delay_s, BODY_SPEED_AGE_S, "s", changed),)
    return (*nuisances(wheels), Nuisance("speed_age_s", encoder.delay_s, SPEED_AGE_S, "s", changed))


def usual_wheels(*, diameter_m: float, track_m: float, counts_per_turn: float) -> KnownWheels:
    """Return the wheels of a robot of which only the drawing is known."""
    radius_m = 0.5 * diameter_m
    return KnownWheels(
        robot=NominalRobot(
            wheel_radius_m=PositiveSpread(value=radius_m, tolerance=WHEEL_SHARE * radius_m),
            wheel_separation_m=PositiveSpread(value=track_m, tolerance=TRACK_SHARE * track_m),
            encoder_ticks_per_revolution=counts_per_turn,
        ),
        wheel_radius_asymmetry=Spread(value=0.0, tolerance=PAIR_SHARE),
    )
