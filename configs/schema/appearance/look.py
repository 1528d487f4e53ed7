"""The look of a run: floor, tape, surfaces, room, light and camera response as plain numbers.

Light is photometric in thousands (klx, kcd/m2, klm); reflectances are linear shares of light, 0 black and 1 white. Yaw
angles count counter-clockwise from +x of the world frame W.
"""

from collections.abc import Iterator
from typing import Annotated, Any, Literal, get_args

from pydantic import Field, model_validator

from configs.schema.appearance.asset import Asset, SurfaceImages
from configs.schema.appearance.camera_look import CameraLook
from configs.schema.appearance.floors import FloorLook
from configs.schema.appearance.lighting import DeskLampsLook, LampsLook, PanoramaName, SkyLook, SunLook
from configs.schema.appearance.paint import Paint
from configs.schema.appearance.room import RoomLook, WindowLook
from configs.schema.base import FromList, Section, Slug, absent

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


class LineSheetsLook(Section):
    """Sheets of paper on the floor, side by side along the line, beneath its tape or paint."""

    width_m: float = Field(default=0.0, ge=0, le=1)
    """Width of the sheets, across the line; 0 for none."""
    length_m: float = Field(default=0.297, ge=0.05, le=2)
    """Length of a sheet, along the line; by default that of A4."""
    shift_m: float = Field(default=0.005, ge=0, le=0.1)
    """Largest shift of a sheet across the line."""
    paint: Paint = Paint(reflectance=0.8, hue_deg=50, saturation=0.02)
    roughness: float = Field(default=0.8, ge=0.05, le=1)
    """Roughness of the surface; 0 is a mirror, 1 is matt."""


def _are_none(sheets: LineSheetsLook) -> bool:
    return sheets == LineSheetsLook()


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
    line_sheets: LineSheetsLook = Field(default=LineSheetsLook(), exclude_if=_are_none)
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
