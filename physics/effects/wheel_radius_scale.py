"""Wheels larger or smaller than believed."""

from dataclasses import replace

from configs.schema.effects.drive import WheelRadiusScale
from physics.effects.base import Slot, Term
from physics.robot.wheel_geometry import WheelGeometry


def scaled(values: WheelRadiusScale, geometry: WheelGeometry) -> WheelGeometry:
    return replace(
        geometry,
        right_radius_m=values.scale * geometry.right_radius_m,
        left_radius_m=values.scale * geometry.left_radius_m,
    )


TERM = Term(
    WheelRadiusScale,
    Slot.GEOMETRY,
    cause="worn or compressed tyres",
    excitation="straight drives of known length",
    apply=scaled,
)
