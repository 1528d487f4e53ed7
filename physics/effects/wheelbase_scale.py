"""Ground contacts further apart or closer than believed."""

from dataclasses import replace

from configs.schema.effects.drive import WheelbaseScale
from physics.effects.base import Slot, Term
from physics.robot.wheel_geometry import WheelGeometry


def scaled(values: WheelbaseScale, geometry: WheelGeometry) -> WheelGeometry:
    return replace(geometry, track_m=values.scale * geometry.track_m)


TERM = Term(
    WheelbaseScale,
    Slot.GEOMETRY,
    cause="wide tyres that bear on an edge, wheels pushed along the shaft",
    excitation="turns of known angle",
    apply=scaled,
)
