"""A sensor that is turned in its mount."""

import numpy as np

from configs.schema.effects.drive import TofMountYaw
from physics.effects.base import Slot, Term
from sensors.range_view import RANGE_SENSORS
from symolo.core.arrays import Array


def turned(values: TofMountYaw, yaw_rad: Array) -> Array:
    return yaw_rad + np.where(values.sensor == RANGE_SENSORS, values.angle_rad, 0.0)


TERM = Term(
    TofMountYaw,
    Slot.RANGE_MOUNT,
    cause="a board that is soldered or screwed down askew",
    excitation="walls met at several angles",
    apply=turned,
)
