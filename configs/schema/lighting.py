"""What shines in the room: sky, sun, ceiling lamps and desk lamps."""

from typing import Annotated, Literal, get_args

from pydantic import Field

from configs.schema.asset import Asset, Named
from configs.schema.base import Section

PanoramaName = Literal["city", "courtyard", "forest", "interior", "night", "studio", "sunrise", "sunset"]
"""The panoramas shipped with bpy."""


class SkyLook(Section):
    panorama: Annotated[PanoramaName | Asset, Named("panorama", get_args(PanoramaName))] = "courtyard"
    """One of those shipped, or a Radiance (.hdr) or OpenEXR file in the folder that `look.assets` names."""
    yaw_deg: float = Field(default=0.0, ge=-360, le=360)
    luminance_kcd_m2: float = Field(default=3.0, ge=0, le=100)
    """Mean over the upper half of the panorama."""
    saturation: float = Field(default=0.45, ge=0, le=2)
    """1 as the panorama was taken; a hazy sky and curtains make less of a blue."""


class SunLook(Section):
    elevation_deg: float = Field(default=35.0, ge=1, le=90)
    azimuth_from_window_deg: float = Field(default=20.0, ge=-180, le=180)
    """From the window's outward normal, counter-clockwise; the sun comes in where it is within about +-70."""
    illuminance_klx: float = Field(default=1.5, ge=0, le=120)
    """On a surface that faces it; a veiled sun or one behind curtains has little, 0 is an overcast day."""
    color_temperature_K: float = Field(default=5200.0, ge=1500, le=15000)
    angular_diameter_deg: float = Field(default=0.8, ge=0.1, le=30)


class FlickerLook(Section):
    """Lamps on alternating current shine brightest twice a period; a short `camera.exposure_time_s` catches a
    part of it, one of whole half periods all.

    All frames vary together with the share of the lamps in the light on the arena.
    """

    depth: float = Field(default=0.0, ge=0, le=1)
    """Amplitude relative to the mean: 0 for electronic ballasts, 0.2-0.5 for tubes on magnetic ones."""
    mains_hz: float = Field(default=50.0, ge=10, le=100)
    """A camera of 5 Hz sees one phase of exactly 50 Hz for ever; a grid wanders by some hundredths."""


class LampsLook(Section):
    """Ceiling lamps in a grid."""

    rows: int = Field(default=2, ge=0, le=10)
    columns: int = Field(default=2, ge=1, le=10)
    length_m: float = Field(default=1.2, ge=0.05, le=5)
    width_m: float = Field(default=0.3, ge=0.02, le=5)
    flux_klm: float = Field(default=4.0, ge=0, le=100)
    """Of one lamp."""
    color_temperature_K: float = Field(default=4000.0, ge=1500, le=15000)
    drop_m: float = Field(default=0.06, ge=0.01, le=3)
    """From the ceiling down to the lamp; at most to 1.8 m above the floor."""
    housing: Literal["none", "batten", "shade"] = "none"
    """A flat panel in the ceiling, a tube below a batten, or a bulb of `width_m` in a conical shade on its cable."""
    flicker: FlickerLook = FlickerLook()


class DeskLampsLook(Section):
    """Lamps on tables, one on each; fewer where there are fewer tables."""

    count: int = Field(default=0, ge=0, le=12)
    flux_klm: float = Field(default=0.5, ge=0, le=20)
    """Of one lamp's bulb, before its shade takes a part."""
    color_temperature_K: float = Field(default=2700.0, ge=1500, le=15000)
    height_m: float = Field(default=0.4, ge=0.2, le=0.8)
    """Of the head above the table."""
    tilt_deg: float = Field(default=45.0, ge=0, le=75)
    """Of the head's axis from straight down, towards the middle of the room."""
