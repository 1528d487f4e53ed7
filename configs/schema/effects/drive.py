"""Effects in a drive log alone: pair of motors, battery, geometry, encoders, ground, logs of pose and ranges."""

from typing import Annotated, Literal

from configs.schema.base import Section
from configs.schema.effects.parameter import Asymmetry, Delay, GeometryScale, Parameter, RangeShift

Side = Literal["left", "right"]
RangeSensor = Literal["front", "left", "right"]


class TorqueConstantMismatch(Section):
    mismatch: Asymmetry
    """K_left = K (1 + mismatch/2), K_right = K (1 - mismatch/2)."""


class BatteryDecline(Section):
    fraction_per_minute: Annotated[float, Parameter("1/min", null=0.0, start=0.03, low=0.0, high=1.0)]
    """u_true = u (1 - fraction * time / 60 s), and 0 once nothing is left."""


class WheelRadiusScale(Section):
    scale: GeometryScale
    """Both radii * scale."""


class WheelRadiusAsymmetry(Section):
    asymmetry: Asymmetry
    """r_left = r (1 + asymmetry/2), r_right = r (1 - asymmetry/2)."""


class WheelbaseScale(Section):
    scale: GeometryScale
    """Wheel separation * scale."""


class EncoderTicksScale(Section):
    scale: GeometryScale
    """True ticks per revolution = scale * nominal."""


class EncoderMissedTicks(Section):
    side: Side
    fraction: Annotated[float, Parameter("1", null=0.0, start=0.1, low=0.0, high=1.0)]
    """This side loses that fraction of its ticks above the threshold, whose edge is 0.3 rad/s soft."""
    threshold_rad_s: Annotated[float, Parameter("rad/s", null=None, start=3.0, low=0.0, high=100.0)]


class TurnSlip(Section):
    coefficient_s2_m: Annotated[float, Parameter("s2/m", null=0.0, start=0.5, low=0.0, high=20.0)]
    """dtheta = dtheta_kinematic / (1 + coefficient * |v * yaw rate|), v and yaw rate by the wheels."""


class MarkerOffset(Section):
    offset_m: Annotated[float, Parameter("m", null=0.0, start=0.02, low=-0.5, high=0.5)]
    """The tracked point lies this far ahead of the axle."""


class PoseTimeOffset(Section):
    delay_s: Delay
    """The logged pose is this much old."""


class TofRangeOffset(Section):
    sensor: RangeSensor
    offset_m: RangeShift
    """Range of that sensor + offset."""


class TofRangeScale(Section):
    scale: GeometryScale
    """All ranges * scale."""


class TofMountYaw(Section):
    sensor: RangeSensor
    angle_rad: Annotated[float, Parameter("rad", null=0.0, start=0.1, low=-1.5, high=1.5)]
    """That sensor points this much further counter-clockwise."""


class TofTimeOffset(Section):
    delay_s: Delay
    """The logged ranges are this much old."""
