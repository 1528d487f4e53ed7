"""Wheels that are larger or smaller than nominal."""

from dataclasses import replace
from typing import Annotated

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import GeometryScale, Plausible
from physics.robot.wheel_geometry import WheelGeometry


class WheelRadiusScale(Effect):
    """Both wheels have the same radius, which differs from the nominal one, so that all distances are scaled."""

    slot = Slot.GEOMETRY
    cause = "worn or compressed tyres"
    excitation = "straight drives of known length"
    setups = (Setup.DRIVE,)

    scale: Annotated[
        GeometryScale, Plausible(0.9, 1.1, "a different tyre would be visible; wear and load are a few per cent")
    ]
    """Both radii * scale."""

    def apply(self, geometry: WheelGeometry) -> WheelGeometry:
        return replace(
            geometry,
            right_radius_m=self.scale * geometry.right_radius_m,
            left_radius_m=self.scale * geometry.left_radius_m,
        )
