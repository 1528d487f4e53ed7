"""A driver that limits its current."""

import numpy as np

from configs.schema.effects.motor import CurrentLimit
from physics.effects.base import Slot, Term
from symolo.core.arrays import Array


def limited(values: CurrentLimit, current_A: Array) -> Array:
    return np.minimum(np.maximum(current_A, -values.limit_A), values.limit_A)


TERM = Term(
    CurrentLimit,
    Slot.CURRENT_LIMIT,
    cause="protection of the bridge",
    excitation="hard starts and reversals",
    apply=limited,
)
