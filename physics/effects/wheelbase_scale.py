"""Ground contacts further apart or closer than believed."""

from dataclasses import replace
from typing import Annotated

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import GeometryScale, Plausible
from physics.robot.wheel_geometry import WheelGeometry


class WheelbaseScale(Effect):
    slot = Slot.GEOMETRY
    cause = "wide tyres that bear on an edge, wheels pushed along the shaft"
    excitation = "turns of known angle"
    setups = (Setup.DRIVE,)

    scale: Annotated[GeometryScale, Plausible(0.9, 1.1, "a tyre touches the floor within its own breadth")]
    """Wheel separation * scale."""

    def apply(self, geometry: WheelGeometry) -> WheelGeometry:
        return replace(geometry, track_m=self.scale * geometry.track_m)
