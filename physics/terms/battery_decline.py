"""A battery that runs down."""

from configs.schema.terms.motor import BatteryDecline
from physics.motion import Array
from physics.terms.base import Slot, Term


def declined(values: BatteryDecline, voltage_V: Array, time_s: float | Array) -> Array:
    return voltage_V * (1.0 - values.fraction_per_minute * time_s / 60.0)


TERM = Term(
    BatteryDecline,
    Slot.BATTERY,
    cause="discharge under a driver that does not regulate",
    excitation="the same commands early and late in the session",
    apply=declined,
)
