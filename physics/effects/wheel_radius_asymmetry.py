"""Two wheels of different size."""

from dataclasses import replace

from configs.schema.effects.drive import WheelRadiusAsymmetry
from physics.effects.base import Slot, Term
from physics.robot.wheel_geometry import WheelGeometry


def asymmetric(values: WheelRadiusAsymmetry, geometry: WheelGeometry) -> WheelGeometry:
    return replace(
        geometry,
        right_radius_m=(1.0 - 0.5 * values.asymmetry) * geometry.right_radius_m,
        left_radius_m=(1.0 + 0.5 * values.asymmetry) * geometry.left_radius_m,
    )


TERM = Term(
    WheelRadiusAsymmetry,
    Slot.GEOMETRY,
    cause="uneven wear, one tyre seated askew",
    excitation="straight drives: the heading drifts with distance",
    apply=asymmetric,
)
