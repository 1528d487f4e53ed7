"""A driver whose voltage follows the command with a lag."""

from configs.schema.effects.motor import ActuatorLag
from physics.drivetrain.first_order import relaxed
from physics.effects.base import Slot, Term
from symolo.core.arrays import Array


def lagged(values: ActuatorLag, held_V: Array, wanted_V: Array, duration_s: float) -> Array:
    return relaxed(held_V, wanted_V, duration_s, values.time_constant_s)


TERM = Term(
    ActuatorLag,
    Slot.ACTUATOR,
    cause="filtered or ramped PWM",
    excitation="steps of voltage: the current rises late",
    apply=lagged,
)
