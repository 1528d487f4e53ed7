"""The robot's right motor with rotor and gearbox, off load, beside the paper's Table 1 and closed forms."""

from configs.schema.robot import RobotConfig
from diagnosis.validation.experiment import Experiment, ValidatedPart
from diagnosis.validation.motor.energy import energy
from diagnosis.validation.motor.steady_states import steady_states
from diagnosis.validation.motor.steps import steps
from diagnosis.validation.motor.stiction import stiction
from symolo.core.errors import InputError


def require_inertia(robot: RobotConfig) -> None:
    """Refuse a motor whose rotor has no inertia, because off load nothing would have a time constant.

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
        Experiment("stiction", "A wheel breaks away where dry friction says, and does not chatter below.", stiction),
        Experiment("energy", "Electrical work is heat and kinetic energy; the motor is without effects here.", energy),
    ),
    require_inertia,
)
