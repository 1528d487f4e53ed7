"""Turns that fall short of what the wheels say, the more the harder."""

import numpy as np

from configs.schema.effects.drive import TurnSlip
from physics.effects.base import Slot, Term
from symolo.core.arrays import Array


def slipped(values: TurnSlip, share: Array, speed_m_s: Array, yaw_rate_rad_s: Array) -> Array:
    return share / (1.0 + values.coefficient_s2_m * np.abs(speed_m_s * yaw_rate_rad_s))


TERM = Term(
    TurnSlip,
    Slot.GROUND,
    cause="tyres that creep under lateral force",
    excitation="arcs at several speeds and curvatures",
    apply=slipped,
)
