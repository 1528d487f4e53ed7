"""Ground contacts that are further apart or closer together than nominal."""

from dataclasses import replace
from typing import Annotated

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import GeometryScale, Plausible
from physics.robot.wheel_geometry import WheelGeometry


class WheelbaseScale(Effect):
    """The distance between the ground contacts of the wheels differs from the nominal one.

    It is the error E_b of Borenstein and Feng, IEEE Trans. Robotics and Automation 12 (1996) 869-880.
    """

    slot = Slot.GEOMETRY
    cause = "wide tyres that touch the floor with one edge, wheels pushed along the shaft"
    excitation = "turns of known angle"
    setups = (Setup.DRIVE,)

    scale: Annotated[GeometryScale, Plausible(0.9, 1.1, "a tyre touches the floor within its own width")]
    """Wheel separation * scale."""

    def apply(self, geometry: WheelGeometry) -> WheelGeometry:
        return replace(geometry, track_m=self.scale * geometry.track_m)
