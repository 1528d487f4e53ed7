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
"""What the line was made with; where it lies is the arena's affair."""


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
    streaks: float = Field(default=0.0, ge=0, le=1)
    """Scuffs along the tape, some millimetres long and in patches, that shine and are paler; 0 for none."""


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


class CameraLook(Section):
    """From the light on the sensor to the numbers in the picture."""

    brightness: float = Field(default=0.25, ge=0.01, le=0.9)
    """What the exposure makes of the median luminance, linear; 0.18 is a photographer's middle grey."""
    compensation_ev: float = Field(default=0.0, ge=-6, le=6)
    exposure_adaption: float = Field(default=0.5, ge=0, le=1)
    """0: one exposure for the whole run, metered on a few of its views; 1: each frame is exposed by its own light."""
    exposure_time_s: float = Field(default=0.0, ge=0, le=0.1)
    """How long each pixel sees, which blurs what moves and evens out lamps that flicker; 0 is an instant.

    Else brightness and noise do not depend on it."""
    white_balance_K: float = Field(default=5000.0, ge=1500, le=15000)
    """The light that is rendered neutral where the white balance is not automatic."""
    white_balance_adaption: float = Field(default=0.8, ge=0, le=1)
    """0: `white_balance_K` holds; 1: the mixed light of lamps and window over the arena is rendered neutral."""
    contrast: float = Field(default=1.15, ge=0.5, le=2)
    saturation: float = Field(default=1.1, ge=0, le=2)
    vignetting: float = Field(default=0.25, ge=0, le=1)
    """Share of light lost in the corner."""
    lens_blur_px: float = Field(default=0.0, ge=0, le=5)
    """Standard deviation of what the lens makes of a point; a cheap one has 0.5 to 1 at 160 x 120."""
    veiling_glare: float = Field(default=0.0, ge=0, le=0.3)
    """Share of the picture's light that the lens spreads evenly over it, which lifts the blacks."""
    shot_noise: float = Field(default=0.012, ge=0, le=0.5)
    """Standard deviation at full white, falling as the root of the light."""
    read_noise: float = Field(default=0.003, ge=0, le=0.5)
    sharpening: float = Field(default=0.0, ge=0, le=3)
    """How much of what a blurred copy lacks is added to the picture, an unsharp mask; 0 is none."""
    sharpening_radius_px: float = Field(default=1.0, ge=0.3, le=10)
    """Standard deviation of that blur."""


_NAMES_A_FILE = {"file": frozenset[str](), "panorama": frozenset(get_args(PanoramaName))}
"""Fields, and the names that stand for no file in each."""


class LookConfig(Section):
    name: Slug
    description: str = ""
    assets: Annotated[tuple[Asset, ...], FromList] | None = Field(default_factory=absent, exclude=True)
    """The folder of the user's own pictures and panoramas, relative to the file that names it.

    Once loaded, the files of it that the look names; what is drawn holds those that it took in their places."""
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
    def _by_content(cls, given: Any) -> Any:  # noqa: ANN401 - whatever is to be validated
        """Names of files give way to what `assets` tells of them."""
        assets = given.get("assets") if isinstance(given, dict) else None
        if not isinstance(assets, list | tuple) or not all(isinstance(asset, dict) for asset in assets):
            return given
        known = {str(asset.get("name")): asset for asset in assets}
        return _told({key: value for key, value in given.items() if key != "assets"}, known)

    @property
    def files(self) -> tuple[Asset, ...]:
        """The user's own files that this look shows, each once."""
        return tuple(dict.fromkeys(_assets(self)))


def _told(given: dict[str, Any], known: dict[str, Any]) -> dict[str, Any]:
    def told(key: str, value: Any) -> Any:  # noqa: ANN401 - likewise
        if isinstance(value, dict):
            return _told(value, known)
        names_a_file = key in _NAMES_A_FILE and isinstance(value, str) and value not in _NAMES_A_FILE[key]
        return known.get(value, value) if names_a_file else value

    return {key: told(key, value) for key, value in given.items()}


def _assets(section: Section) -> Iterator[Asset]:
    for _, value in section:
        if isinstance(value, Asset):
            yield value
        elif isinstance(value, Section):
            yield from _assets(value)
