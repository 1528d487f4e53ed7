"""A supply that gives way under load."""

import numpy as np

from configs.schema.effects.motor import SupplySag
from physics.drivetrain.bridge import Bridge
from physics.effects.base import Slot, Term
from symolo.core.arrays import Array

NEWTON_STEPS = 5
"""The loss is convex in itself and straight between the kinks where a current begins, ends or turns: two of each of two
motors. From zero loss Newton's method passes each at most once, and between two it is exact."""
MIN_SLOPE = 1e-9


def sagged_current_A(values: SupplySag, emf_V: Array, bridge: Bridge) -> Array:
    """Current of each motor [A], the motors of one supply along the last axis.

    The supply loses r (sum of |duty| |I|), all that it has at most, and each motor its share of that by duty. One motor
    alone follows GAP_FORMAT's formula, also while it feeds back.
    """
    source, duty, resistance_ohm = values.source_resistance_ohm, bridge.duty, bridge.resistance_ohm
    if emf_V.shape[-1] == 1:
        return bridge.driving_V(emf_V) / (resistance_ohm + source * duty**2)
    draws_V = source * np.abs(duty)
    eases = draws_V * duty / resistance_ohm
    lost_V = np.zeros((*emf_V.shape[:-1], 1))
    sign = np.full(emf_V.shape, np.nan)
    for _ in range(NEWTON_STEPS):
        current = bridge.current_A(emf_V - duty * lost_V)
        before, sign = sign, np.sign(current)
        if np.array_equal(sign, before):
            return current
        off_V = (draws_V * np.abs(current)).sum(axis=-1, keepdims=True) - lost_V
        slope = 1.0 + (eases * sign).sum(axis=-1, keepdims=True)
        lost_V = np.minimum(lost_V + off_V / np.maximum(slope, MIN_SLOPE), bridge.supply_V)
    return bridge.current_A(emf_V - duty * lost_V)


TERM = Term(
    SupplySag,
    Slot.SUPPLY,
    cause="internal resistance of the cells, thin leads",
    excitation="full duty against part duty, one wheel stalled while the other runs",
    apply=sagged_current_A,
)
