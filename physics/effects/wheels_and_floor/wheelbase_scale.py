"""Ground contacts that are further apart or closer together than nominal."""

from dataclasses import replace
from typing import Annotated

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import GeometryScale, Plausible
from physics.robot.wheel_geometry import WheelGeometry


class WheelbaseScale(Effect):
    slot = Slot.GEOMETRY
    cause = "wide tyres that touch the floor with one edge, wheels pushed along the shaft"
    excitation = "turns of known angle"
    setups = (Setup.DRIVE,)

    scale: Annotated[GeometryScale, Plausible(0.9, 1.1, "a tyre touches the floor within its own width")]
    """Wheel separation * scale."""

    def apply(self, geometry: WheelGeometry) -> WheelGeometry:
        return replace(geometry, track_m=self.scale * geometry.track_m)
