"""Two wheels of different sizes."""

from dataclasses import replace
from typing import Annotated

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Asymmetry, Plausible
from physics.robot.wheel_geometry import WheelGeometry


class WheelRadiusAsymmetry(Effect):
    """The radii r of both wheels differ in opposite directions from their mean, which is nominal.

    It is the error E_d of Borenstein and Feng, IEEE Trans. Robotics and Automation 12 (1996) 869-880.
    """

    slot = Slot.GEOMETRY
    cause = "uneven wear, a tyre that is mounted unevenly"
    excitation = "straight drives, in which the heading drifts with the distance"
    setups = (Setup.DRIVE,)

    asymmetry: Annotated[Asymmetry, Plausible(-0.1, 0.1, "for two wheels of the same type, one per cent is much")]
    """r_left = r (1 + asymmetry/2), r_right = r (1 - asymmetry/2)."""

    def apply(self, geometry: WheelGeometry) -> WheelGeometry:
        return replace(
            geometry,
            right_radius_m=(1.0 - 0.5 * self.asymmetry) * geometry.right_radius_m,
            left_radius_m=(1.0 + 0.5 * self.asymmetry) * geometry.left_radius_m,
        )
