"""A battery that runs down."""

import numpy as np

from configs.schema.effects.drive import BatteryDecline
from physics.effects.base import Slot, Term
from symolo.core.arrays import Array


def declined(values: BatteryDecline, voltage_V: Array, time_s: float | Array) -> Array:
    """GAP_FORMAT's straight line, until nothing is left."""
    return voltage_V * np.maximum(1.0 - values.fraction_per_minute * time_s / 60.0, 0.0)


TERM = Term(
    BatteryDecline,
    Slot.BATTERY,
    cause="discharge under a driver that does not regulate",
    excitation="the same commands early and late in the session",
    apply=declined,
)
