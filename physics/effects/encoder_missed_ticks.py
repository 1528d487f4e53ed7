"""An encoder that loses counts at speed."""

import numpy as np

from configs.schema.effects.drive import EncoderMissedTicks
from physics.effects.base import Slot, Term
from symolo.core.arrays import Array

SIDES = np.array(["right", "left"])
EDGE_RAD_S = 0.3
"""Softness of the threshold: the loss is half at it, and logistic in the speed with this width."""


def counted(values: EncoderMissedTicks, turned_rad: Array, duration_s: float) -> Array:
    speed_rad_s = np.abs(turned_rad) / duration_s
    beyond = np.clip((speed_rad_s - values.threshold_rad_s) / EDGE_RAD_S, -40.0, 40.0)
    lost = values.fraction / (1.0 + np.exp(-beyond))
    kept = np.where(values.side == SIDES, 1.0 - lost, 1.0)
    return turned_rad * kept


TERM = Term(
    EncoderMissedTicks,
    Slot.COUNTING,
    cause="a weak or misaligned sensor, an interrupt routine that is too slow",
    excitation="slow and fast drives of the same length",
    apply=counted,
)
