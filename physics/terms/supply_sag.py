"""A supply that gives way under load."""

import numpy as np

from configs.schema.terms.motor import SupplySag
from physics.motion import Array
from physics.terms.base import Slot, Term


def sagged_current_A(values: SupplySag, emf_V: Array, resistance_ohm: Array, duty: Array) -> Array:
    """Current of each motor [A], the motors of one supply along the last axis.

    The supply loses r (sum of |duty| |I|), and each motor its share by duty; with the signs of the currents known the
    loss is linear in itself. One motor alone follows GAP_FORMAT's formula, also while it feeds back.
    """
    source = values.source_resistance_ohm
    alone = emf_V / resistance_ohm
    share = duty * source / resistance_ohm
    if emf_V.shape[-1] == 1:
        return (emf_V - duty * (source * duty * alone / (1.0 + duty * share))) / resistance_ohm
    current = alone
    for _ in range(SIGN_TRIALS):
        sign = np.sign(current)
        load_A = np.sum(np.abs(duty) * sign * alone, axis=-1, keepdims=True)
        load_A = load_A / (1.0 + np.sum(np.abs(duty) * sign * share, axis=-1, keepdims=True))
        current = (emf_V - duty * (source * load_A)) / resistance_ohm
    return current


SIGN_TRIALS = 3
"""The loss turns a motor's current round only where that is small; two motors have settled by then."""


TERM = Term(
    SupplySag,
    Slot.SUPPLY,
    cause="internal resistance of the cells, thin leads",
    excitation="full duty against part duty, one wheel stalled while the other runs",
    apply=sagged_current_A,
)
