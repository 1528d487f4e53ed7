"""The look of a run: floor, tape, surfaces, room, light and camera response as plain numbers.

Light is photometric in thousands (klx, kcd/m2, klm); reflectances are linear shares of light, 0 black and 1 white. Yaw
angles count counter-clockwise from +x of the world frame W.
"""

from typing import Literal

from pydantic import Field

from configs.schema.base import Section, Slug
from configs.schema.floors import FloorLook
from configs.schema.paint import Paint

LineKind = Literal["tape", "paint"]
"""What the line was made with; where it lies is the arena's affair."""

PanoramaName = Literal["city", "courtyard", "forest", "interior", "night", "studio", "sunrise", "sunset"]
"""The panoramas shipped with bpy."""


class TapeLook(Section):
    """The tape of the line, laid piece by piece with butt joints."""

    paint: Paint = Paint(reflectance=0.035, hue_deg=30, saturation=0.05)
    roughness: float = Field(default=0.5, ge=0.05, le=1)
    """0.5 a matt cloth or crepe tape, 0.2 a glossy PVC tape."""
    thickness_m: float = Field(default=0.00013, ge=0.00001, le=0.001)
    wear: float = Field(default=0.4, ge=0, le=1)
    """Scuffs, dust and glossy spots."""
    gap_m: float = Field(default=0.0004, ge=0, le=0.002)
    """Between the ends of two pieces that meet; 0 where they touch."""
    lift_m: float = Field(default=0.0003, ge=0, le=0.002)
    """How far corners and edges come off the floor here and there; 0 where the tape sticks all over."""
    wrinkles: float = Field(default=0.3, ge=0, le=1)
    """Folds, most of them along the inner edge of bends."""


class LinePaintLook(Section):
    """A line painted between masking tapes."""

    paint: Paint = Paint(reflectance=0.04, hue_deg=220, saturation=0.05)
    roughness: float = Field(default=0.65, ge=0.05, le=1)
    thickness_m: float = Field(default=0.00005, ge=0.00001, le=0.001)
    bleeding_m: float = Field(default=0.0004, ge=0, le=0.0009)
    """How far the paint crept under the masking tape at most; its mean edge stays that of the line."""
    wear: float = Field(default=0.3, ge=0, le=1)
    """Scuffs, dust and thin places."""


class BoardLook(Section):
    """Painted walls and boards of the arena; the reflectance follows from the surface's name."""

    roughness: float = Field(default=0.55, ge=0.05, le=1)
    tint_hue_deg: float = Field(default=45.0, ge=-360, le=360)
    tint_saturation: float = Field(default=0.04, ge=0, le=1)
    wear: float = Field(default=0.3, ge=0, le=1)
    length_m: float = Field(default=0.6, ge=0.05, le=10)
    """Of one board; a wall is made of several that meet in narrow seams."""


class CardboardLook(Section):
    paint: Paint = Paint(reflectance=0.3, hue_deg=30, saturation=0.52)
    wear: float = Field(default=0.3, ge=0, le=1)
    tape: Paint = Paint(reflectance=0.26, hue_deg=28, saturation=0.6)
    tape_drop_m: float = Field(default=0.035, ge=0, le=1)
    """How far the packing tape comes down the sides."""


class BrickLook(Section):
    """Bare brickwork in running bond."""

    paint: Paint = Paint(reflectance=0.2, hue_deg=14, saturation=0.62)
    joint: Paint = Paint(reflectance=0.42, hue_deg=40, saturation=0.1)
    variation: float = Field(default=0.3, ge=0, le=1)
    """Spread of reflectance from brick to brick."""
    length_m: float = Field(default=0.21, ge=0.02, le=1)
    height_m: float = Field(default=0.052, ge=0.01, le=0.5)
    joint_m: float = Field(default=0.009, ge=0.001, le=0.05)


class PaintedLook(Section):
    """A material of one colour and gloss."""

    paint: Paint
    roughness: float = Field(ge=0.02, le=1)


class GlossLook(Section):
    """A material whose colour is its nature."""

    roughness: float = Field(ge=0.0, le=1)


class RoomLook(Section):
    """The room around the arena, a box whose walls keep the margins from the arena's bounds."""

    margin_east_m: float = Field(default=2.0, ge=1.3, le=30)
    margin_north_m: float = Field(default=1.8, ge=1.3, le=30)
    margin_west_m: float = Field(default=2.2, ge=1.3, le=30)
    margin_south_m: float = Field(default=1.6, ge=1.3, le=30)
    height_m: float = Field(default=2.8, ge=2, le=10)
    wall: Paint = Paint(reflectance=0.7, hue_deg=48, saturation=0.08)
    skirting: Paint = Paint(reflectance=0.45, hue_deg=30, saturation=0.3)
    skirting_height_m: float = Field(default=0.07, ge=0.01, le=0.5)


class WindowLook(Section):
    side: Literal["east", "north", "west", "south"] = "east"
    width_m: float = Field(default=2.4, ge=0.2, le=20)
    height_m: float = Field(default=1.5, ge=0.2, le=8)
    """Less where the ceiling is too low for it."""
    sill_m: float = Field(default=0.9, ge=0.0, le=3)
    panes: int = Field(default=3, ge=1, le=20)
    """Side by side, with a bar between two of them."""


class SkyLook(Section):
    panorama: PanoramaName = "courtyard"
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


class LampsLook(Section):
    """Flat ceiling lamps in a grid."""

    rows: int = Field(default=2, ge=0, le=10)
    columns: int = Field(default=2, ge=1, le=10)
    length_m: float = Field(default=1.2, ge=0.05, le=5)
    width_m: float = Field(default=0.3, ge=0.02, le=5)
    flux_klm: float = Field(default=4.0, ge=0, le=100)
    """Of one lamp."""
    color_temperature_K: float = Field(default=4000.0, ge=1500, le=15000)


class CameraLook(Section):
    """From the light on the sensor to the numbers in the picture."""

    brightness: float = Field(default=0.25, ge=0.01, le=0.9)
    """What the exposure makes of the median luminance, linear; 0.18 is a photographer's middle grey."""
    compensation_ev: float = Field(default=0.0, ge=-6, le=6)
    exposure_adaption: float = Field(default=0.5, ge=0, le=1)
    """0: one exposure for the whole run, metered on a few of its views; 1: each frame is exposed by its own light."""
    white_balance_K: float = Field(default=5000.0, ge=1500, le=15000)
    """The light that is rendered neutral where the white balance is not automatic."""
    white_balance_adaption: float = Field(default=0.8, ge=0, le=1)
    """0: `white_balance_K` holds; 1: the mixed light of lamps and window over the arena is rendered neutral."""
    contrast: float = Field(default=1.15, ge=0.5, le=2)
    saturation: float = Field(default=1.1, ge=0, le=2)
    vignetting: float = Field(default=0.25, ge=0, le=1)
    """Share of light lost in the corner."""
    shot_noise: float = Field(default=0.012, ge=0, le=0.5)
    """Standard deviation at full white, falling as the root of the light."""
    read_noise: float = Field(default=0.003, ge=0, le=0.5)


class LookConfig(Section):
    name: Slug
    description: str = ""
    floor: FloorLook = FloorLook()
    line: LineKind = "tape"
    tape: TapeLook = TapeLook()
    line_paint: LinePaintLook = LinePaintLook()
    boards: BoardLook = BoardLook()
    cardboard: CardboardLook = CardboardLook()
    plastic: PaintedLook = PaintedLook(paint=Paint(reflectance=0.25, hue_deg=215, saturation=0.7), roughness=0.3)
    wood: PaintedLook = PaintedLook(paint=Paint(reflectance=0.42, hue_deg=34, saturation=0.5), roughness=0.5)
    plywood: PaintedLook = PaintedLook(paint=Paint(reflectance=0.48, hue_deg=36, saturation=0.42), roughness=0.6)
    brick: BrickLook = BrickLook()
    paper: PaintedLook = PaintedLook(paint=Paint(reflectance=0.82, hue_deg=50, saturation=0.03), roughness=0.9)
    metal: GlossLook = GlossLook(roughness=0.3)
    glass: GlossLook = GlossLook(roughness=0.05)
    room: RoomLook = RoomLook()
    window: WindowLook = WindowLook()
    sky: SkyLook = SkyLook()
    sun: SunLook = SunLook()
    lamps: LampsLook = LampsLook()
    camera: CameraLook = CameraLook()
