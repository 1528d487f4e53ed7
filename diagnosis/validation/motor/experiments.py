"""Experiments with the right motor, rotor and gearbox without load, against Table 1 of the paper and closed forms."""

from configs.schema.robot import RobotConfig
from diagnosis.validation.experiment import Experiment, ValidatedPart
from diagnosis.validation.motor.energy import energy
from diagnosis.validation.motor.steady_states import steady_states
from diagnosis.validation.motor.steps import steps
from diagnosis.validation.motor.stiction import stiction
from symolo.core.errors import InputError


def require_inertia(robot: RobotConfig) -> None:
    """Refuse a motor whose rotor has no inertia, since without load it would have no time constant.

    Raises:
        InputError: The inertia is 0.
    """
    if robot.motor.rotor_inertia_kg_m2 == 0.0:
        raise InputError("robot.motor.rotor_inertia_kg_m2", got=0.0, allowed="above 0 for a motor off load")


MOTOR = ValidatedPart(
    "motor",
    (
        Experiment("steady_states", "Speed and current at the voltages of Table 1 (paper Fig. 10).", steady_states),
        Experiment("steps", "Steps of voltage from rest follow the time constant of Eq. 20.", steps),
        Experiment(
            "stiction", "A wheel breaks away at the voltage of dry friction, and does not chatter below it.", stiction
        ),
        Experiment("energy", "Electrical work becomes heat and kinetic energy, for the motor without effects.", energy),
    ),
    require_inertia,
)
