"""Voltage that is lost in the transistors of the bridge."""

import numpy as np

from configs.schema.effects.motor import BridgeVoltageDrop
from physics.effects.base import Slot, Term
from symolo.core.arrays import Array


def dropped(values: BridgeVoltageDrop, emf_V: Array) -> Array:
    return np.copysign(np.maximum(np.abs(emf_V) - values.drop_V, 0.0), emf_V)


TERM = Term(
    BridgeVoltageDrop,
    Slot.BRIDGE,
    cause="saturation voltage of bipolar bridges, body diodes",
    excitation="low voltages of both signs, and current at rest",
    apply=dropped,
)
