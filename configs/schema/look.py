"""The look of a run: floor, tape, surfaces, room, light and camera response as plain numbers.

Light is photometric in thousands (klx, kcd/m2, klm); reflectances are linear shares of light, 0 black and 1 white. Yaw
angles count counter-clockwise from +x of the world frame W.
"""

from collections.abc import Iterator
from typing import Annotated, Any, Literal, get_args

from pydantic import Field, model_validator

from configs.schema.asset import Asset, SurfaceImages
from configs.schema.base import FromList, Section, Slug, absent
from configs.schema.floors import FloorLook
from configs.schema.lighting import DeskLampsLook, LampsLook, PanoramaName, SkyLook, SunLook
from configs.schema.paint import Paint
from configs.schema.room import RoomLook, WindowLook

LineKind = Literal["tape", "paint"]
"""Material of the line; the arena defines its course."""


class TapeLook(Section):
    """The tape of the line, laid piece by piece with butt joints."""

    paint: Paint = Paint(reflectance=0.035, hue_deg=30, saturation=0.05)
    roughness: float = Field(default=0.5, ge=0.05, le=1)
    """Roughness: 0.5 for a matt cloth or crepe tape, 0.2 for a glossy PVC tape."""
    thickness_m: float = Field(default=0.00013, ge=0.00001, le=0.001)
    """Thickness of the tape [m]."""
    wear: float = Field(default=0.4, ge=0, le=1)
    """Amount of scuffs, dust and glossy spots."""
    gap_m: float = Field(default=0.0004, ge=0, le=0.002)
    """Gap between the ends of two pieces; 0 if they touch."""
    lift_m: float = Field(default=0.0003, ge=0, le=0.002)
    """Height to which corners and edges come off the floor in places; 0 if the tape sticks everywhere."""
    wrinkles: float = Field(default=0.3, ge=0, le=1)
    """Amount of folds, most of them along the inner edge of bends."""
    streaks: float = Field(default=0.0, ge=0, le=1)
    """Amount of pale, shiny scuffs along the tape, in patches and a few millimetres long; 0 is none."""


class LinePaintLook(Section):
    """A line painted between masking tapes."""

    paint: Paint = Paint(reflectance=0.04, hue_deg=220, saturation=0.05)
    roughness: float = Field(default=0.65, ge=0.05, le=1)
    """Roughness of the surface; 0 is a mirror, 1 is matt."""
    thickness_m: float = Field(default=0.00005, ge=0.00001, le=0.001)
    """Thickness of the paint [m]."""
    bleeding_m: float = Field(default=0.0004, ge=0, le=0.0009)
    """Largest distance that the paint crept under the masking tape; the mean edge is that of the line."""
    wear: float = Field(default=0.3, ge=0, le=1)
    """Amount of scuffs, dust and thin places."""


class BoardLook(Section):
    """Painted walls and boards of the arena; the reflectance follows from the surface's name."""

    roughness: float = Field(default=0.55, ge=0.05, le=1)
    """Roughness of the surface; 0 is a mirror, 1 is matt."""
    tint_hue_deg: float = Field(default=45.0, ge=-360, le=360)
    """Hue of the boards: 0 red, 60 yellow, 120 green, 240 blue."""
    tint_saturation: float = Field(default=0.04, ge=0, le=1)
    """Saturation of that hue; 0 is grey."""
    wear: float = Field(default=0.3, ge=0, le=1)
    """Amount of scuffs, and of grime along the floor."""
    length_m: float = Field(default=0.6, ge=0.05, le=10)
    """Length of one board; a wall consists of several with narrow seams."""


class CardboardLook(Section):
    """Cardboard of boxes, with packing tape."""

    paint: Paint = Paint(reflectance=0.3, hue_deg=30, saturation=0.52)
    wear: float = Field(default=0.3, ge=0, le=1)
    """Amount of worn edges and creases."""
    tape: Paint = Paint(reflectance=0.26, hue_deg=28, saturation=0.6)
    """Colour of the packing tape."""
    tape_drop_m: float = Field(default=0.035, ge=0, le=1)
    """Length of the packing tape on the sides."""


class BrickLook(Section):
    """Bare brickwork in running bond."""

    paint: Paint = Paint(reflectance=0.2, hue_deg=14, saturation=0.62)
    joint: Paint = Paint(reflectance=0.42, hue_deg=40, saturation=0.1)
    """Colour of the mortar."""
    variation: float = Field(default=0.3, ge=0, le=1)
    """Spread of reflectance from brick to brick."""
    length_m: float = Field(default=0.21, ge=0.02, le=1)
    """Length of a brick [m]."""
    height_m: float = Field(default=0.052, ge=0.01, le=0.5)
    """Height of a brick [m]."""
    joint_m: float = Field(default=0.009, ge=0.001, le=0.05)
    """Width of the joints [m]."""


class PaintedLook(Section):
    """A material of one colour and gloss."""

    paint: Paint
    roughness: float = Field(ge=0.02, le=1)
    """Roughness of the surface; 0 is a mirror, 1 is matt."""


class GlossLook(Section):
    """A material of fixed colour."""

    roughness: float = Field(ge=0.0, le=1)
    """Roughness of the surface; 0 is a mirror, 1 is matt."""


class CameraLook(Section):
    """Camera response, from the light on the sensor to the numbers in the image."""

    brightness: float = Field(default=0.25, ge=0.01, le=0.9)
    """Linear value to which the exposure brings the median luminance; 0.18 is a photographer's middle grey."""
    compensation_ev: float = Field(default=0.0, ge=-6, le=6)
    """Exposure compensation in stops; +1 doubles the light."""
    exposure_adaption: float = Field(default=0.5, ge=0, le=1)
    """Adaption of the exposure: 0 is one exposure per run, metered on a few of its views; 1 meters each frame."""
    exposure_time_s: float = Field(default=0.0, ge=0, le=0.1)
    """Exposure time of each pixel, which causes motion blur and averages flicker; 0 is an instant. Brightness and noise
    do not depend on it otherwise."""
    white_balance_K: float = Field(default=5000.0, ge=1500, le=15000)
    """Colour temperature that is rendered neutral without automatic white balance."""
    white_balance_adaption: float = Field(default=0.8, ge=0, le=1)
    """Adaption of the white balance: 0 uses `white_balance_K`; 1 renders the mixed light over the arena neutral."""
    contrast: float = Field(default=1.15, ge=0.5, le=2)
    """Slope of the tone curve around its middle; 1 leaves the contrast unchanged."""
    saturation: float = Field(default=1.1, ge=0, le=2)
    """Factor on the saturation of colours; 0 is grey."""
    vignetting: float = Field(default=0.25, ge=0, le=1)
    """Share of light that is lost in the corners."""
    lens_blur_px: float = Field(default=0.0, ge=0, le=5)
    """Standard deviation of the lens' point spread; a cheap lens has 0.5 to 1 at 160 x 120."""
    veiling_glare: float = Field(default=0.0, ge=0, le=0.3)
    """Share of the light that the lens spreads evenly over the image, which raises the black level."""
    shot_noise: float = Field(default=0.012, ge=0, le=0.5)
    """Standard deviation at full white, proportional to the root of the light."""
    read_noise: float = Field(default=0.003, ge=0, le=0.5)
    """Standard deviation of the noise in the dark, relative to full white."""
    sharpening: float = Field(default=0.0, ge=0, le=3)
    """Strength of an unsharp mask; 0 is none."""
    sharpening_radius_px: float = Field(default=1.0, ge=0.3, le=10)
    """Standard deviation of the blur of the unsharp mask."""


_SHIPPED_NAMES = {"file": frozenset[str](), "panorama": frozenset(get_args(PanoramaName))}
"""Fields that may name a file, with the names that are not files."""


class LookConfig(Section):
    """Materials, room, light and camera response."""

    name: Slug
    """Name of the look."""
    description: str = ""
    """Description for people."""
    assets: Annotated[tuple[Asset, ...], FromList] | None = Field(default_factory=absent, exclude=True)
    """Folder of the user's images and panoramas, relative to the file that names it. After loading, the files that the
    look names; a specification has these files in the places of their names."""
    floor: FloorLook = FloorLook()
    line: LineKind = "tape"
    """Material of the line: `tape` or `paint`; only the section of that kind is used."""
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
    images: SurfaceImages = SurfaceImages()
    room: RoomLook = RoomLook()
    window: WindowLook = WindowLook()
    sky: SkyLook = SkyLook()
    sun: SunLook = SunLook()
    lamps: LampsLook = LampsLook()
    desk_lamps: DeskLampsLook = DeskLampsLook()
    camera: CameraLook = CameraLook()

    @model_validator(mode="before")
    @classmethod
    def _by_content(cls, value: Any) -> Any:  # noqa: ANN401 - whatever is to be validated
        """Replace names of files by their entries in `assets`."""
        assets = value.get("assets") if isinstance(value, dict) else None
        if not isinstance(assets, list | tuple) or not all(isinstance(asset, dict) for asset in assets):
            return value
        known = {str(asset.get("name")): asset for asset in assets}
        return _with_files({key: item for key, item in value.items() if key != "assets"}, known)

    @property
    def files(self) -> tuple[Asset, ...]:
        """Files of the user that this look shows, each once."""
        return tuple(dict.fromkeys(_assets(self)))


def _with_files(section: dict[str, Any], known: dict[str, Any]) -> dict[str, Any]:
    def with_file(key: str, value: Any) -> Any:  # noqa: ANN401 - as above
        if isinstance(value, dict):
            return _with_files(value, known)
        names_a_file = key in _SHIPPED_NAMES and isinstance(value, str) and value not in _SHIPPED_NAMES[key]
        return known.get(value, value) if names_a_file else value

    return {key: with_file(key, value) for key, value in section.items()}


def _assets(section: Section) -> Iterator[Asset]:
    for _, value in section:
        if isinstance(value, Asset):
            yield value
        elif isinstance(value, Section):
            yield from _assets(value)
