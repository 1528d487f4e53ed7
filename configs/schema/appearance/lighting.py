"""Light sources of the room: sky, sun, ceiling lamps and desk lamps."""

from typing import Annotated, Literal, get_args

from pydantic import Field

from configs.schema.appearance.asset import Asset, NamedFile
from configs.schema.base import Section

PanoramaName = Literal["city", "courtyard", "forest", "interior", "night", "studio", "sunrise", "sunset"]
"""The panoramas shipped with bpy."""


class SkyLook(Section):
    """The sky outside the window, a panorama."""

    panorama: Annotated[PanoramaName | Asset, NamedFile("panorama", get_args(PanoramaName))] = "courtyard"
    """Shipped panorama, or a Radiance (.hdr) or OpenEXR file in the folder that `look.assets` names."""
    yaw_deg: float = Field(default=0.0, ge=-360, le=360)
    """Rotation of the panorama about the vertical, counter-clockwise."""
    luminance_kcd_m2: float = Field(default=3.0, ge=0, le=100)
    """Mean luminance of the upper half of the panorama."""
    saturation: float = Field(default=0.45, ge=0, le=2)
    """Factor on the saturation of the panorama; haze and curtains make a sky less blue."""


class SunLook(Section):
    """The sun outside the window."""

    elevation_deg: float = Field(default=35.0, ge=1, le=90)
    """Angle of the sun above the horizon."""
    azimuth_from_window_deg: float = Field(default=20.0, ge=-180, le=180)
    """Azimuth from the window's outward normal, counter-clockwise; within about +-70 the sun shines in."""
    illuminance_klx: float = Field(default=1.5, ge=0, le=120)
    """Illuminance on a surface that faces the sun; small for a veiled sun or curtains, 0 for an overcast day."""
    color_temperature_K: float = Field(default=5200.0, ge=1500, le=15000)
    """Colour temperature [K]; lower is warmer."""
    angular_diameter_deg: float = Field(default=0.8, ge=0.1, le=30)
    """Apparent diameter of the sun; a larger one casts softer shadows. The real sun has 0.53."""


class FlickerLook(Section):
    """Flicker of lamps on alternating current, with two maxima per period.

    A short `camera.exposure_time_s` catches a part of a period; one of whole half periods averages it. The brightness
    of frames varies with the share of the lamps in the light on the arena.
    """

    depth: float = Field(default=0.0, ge=0, le=1)
    """Amplitude relative to the mean: 0 for electronic ballasts, 0.2-0.5 for tubes on magnetic ones."""
    mains_hz: float = Field(default=50.0, ge=10, le=100)
    """Mains frequency. A camera of 5 Hz sees a constant phase at exactly 50 Hz; real grids vary by hundredths."""


class LampsLook(Section):
    """Ceiling lamps in a grid."""

    rows: int = Field(default=2, ge=0, le=10)
    """Number of rows of lamps along y of W; 0 for no lamps."""
    columns: int = Field(default=2, ge=1, le=10)
    """Number of lamps in a row, along x of W."""
    length_m: float = Field(default=1.2, ge=0.05, le=5)
    """Length of a lamp [m]."""
    width_m: float = Field(default=0.3, ge=0.02, le=5)
    """Width of a lamp [m]."""
    flux_klm: float = Field(default=4.0, ge=0, le=100)
    """Luminous flux of one lamp."""
    color_temperature_K: float = Field(default=4000.0, ge=1500, le=15000)
    """Colour temperature [K]; lower is warmer."""
    drop_m: float = Field(default=0.06, ge=0.01, le=3)
    """Distance from the ceiling down to the lamp, which stays at least 1.8 m above the floor."""
    housing: Literal["none", "batten", "shade"] = "none"
    """Housing: `none` is a flat panel in the ceiling, `batten` a tube below a batten, `shade` a bulb of `width_m` in a
    conical shade on its cable."""
    flicker: FlickerLook = FlickerLook()


class DeskLampsLook(Section):
    """Lamps on tables, at most one on each."""

    count: int = Field(default=0, ge=0, le=12)
    """Number of desk lamps; at most one stands on each table."""
    flux_klm: float = Field(default=0.5, ge=0, le=20)
    """Luminous flux of the bulb, before losses in the shade."""
    color_temperature_K: float = Field(default=2700.0, ge=1500, le=15000)
    """Colour temperature [K]; lower is warmer."""
    height_m: float = Field(default=0.4, ge=0.2, le=0.8)
    """Height of the head above the table."""
    tilt_deg: float = Field(default=45.0, ge=0, le=75)
    """Angle of the head's axis from straight down, towards the middle of the room."""
