"""A range sensor that is rotated in its mount."""

from typing import Annotated, Literal

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from sensors.ranging.range_view import RANGE_SENSORS
from symolo.core.arrays import Array


class TofMountYaw(Effect):
    """One of the three range sensors of the robot points in another direction than its description states."""

    slot = Slot.RANGE_MOUNT
    cause = "a sensor board that is soldered or mounted at a wrong angle"
    excitation = "walls at several angles"
    setups = (Setup.DRIVE,)

    sensor: Literal["front", "left", "right"]
    """Sensor that is rotated."""
    angle_rad: Annotated[float, Parameter("rad", null=0.0, start=0.1, low=-1.5, high=1.5)]
    """Rotation of that sensor from its nominal direction, counter-clockwise."""

    def apply(self, yaw_rad: Array) -> Array:
        return yaw_rad + np.where(self.sensor == RANGE_SENSORS, self.angle_rad, 0.0)
