"""The floors that a look can lay under the arena."""

from typing import Literal

from pydantic import Field

from configs.schema.appearance.asset import ImageLook
from configs.schema.appearance.paint import Paint
from configs.schema.base import Section

FloorName = Literal[
    "linoleum", "ceramic_tile", "parquet", "concrete", "carpet", "plywood", "paper_sheets", "vinyl", "image"
]
"""`blender_scenes.materials.floors` has a module for each, with a function of this name."""


class Linoleum(Section):
    """Marbled sheet with a worn wax gloss."""

    paint: Paint = Paint(reflectance=0.55, hue_deg=40, saturation=0.12)
    marbling: float = Field(default=0.15, ge=0, le=1)
    """Depth of the streaks relative to the mean reflectance."""
    roughness: float = Field(default=0.35, ge=0.05, le=1)
    """Roughness of the surface; 0 is a mirror, 1 is matt."""


class CeramicTile(Section):
    """Square tiles with joints of grout."""

    paint: Paint = Paint(reflectance=0.6, hue_deg=35, saturation=0.08)
    joint: Paint = Paint(reflectance=0.3, hue_deg=35, saturation=0.1)
    """Colour of the grout in the joints."""
    size_m: float = Field(default=0.33, ge=0.02, le=2)
    """Side of a square tile, from the middle of one joint to that of the next."""
    joint_width_m: float = Field(default=0.004, ge=0.0005, le=0.03)
    """Width of the joints between tiles."""
    variation: float = Field(default=0.06, ge=0, le=1)
    """Spread of reflectance from tile to tile and within one."""
    roughness: float = Field(default=0.25, ge=0.05, le=1)
    """Roughness of the surface; 0 is a mirror, 1 is matt."""


class Parquet(Section):
    """Wooden planks, laid in rows with shifted ends."""

    paint: Paint = Paint(reflectance=0.34, hue_deg=30, saturation=0.5)
    plank_length_m: float = Field(default=0.5, ge=0.05, le=5)
    """Length of a plank, from the middle of one gap to that of the next."""
    plank_width_m: float = Field(default=0.07, ge=0.01, le=1)
    """Width of a plank, from the middle of one gap to that of the next."""
    gap_m: float = Field(default=0.0005, ge=0, le=0.01)
    """Width of the gaps between planks."""
    variation: float = Field(default=0.35, ge=0, le=1)
    """Spread of reflectance from plank to plank."""
    roughness: float = Field(default=0.35, ge=0.05, le=1)
    """Roughness of the surface; 0 is a mirror, 1 is matt."""


class Concrete(Section):
    """Power-floated slab with clouds, pores and hairline marks."""

    paint: Paint = Paint(reflectance=0.4, hue_deg=45, saturation=0.06)
    clouding: float = Field(default=0.25, ge=0, le=1)
    """Contrast of the clouds, relative to the mean reflectance."""
    roughness: float = Field(default=0.6, ge=0.05, le=1)
    """Roughness of the surface; 0 is a mirror, 1 is matt."""


class Carpet(Section):
    """Carpet tiles of loop pile, each with a slightly different shade."""

    paint: Paint = Paint(reflectance=0.3, hue_deg=215, saturation=0.15)
    loop_m: float = Field(default=0.003, ge=0.001, le=0.02)
    """Distance from one loop of yarn to the next."""
    mottling: float = Field(default=0.3, ge=0, le=1)
    """Spread of reflectance from loop to loop."""
    tile_size_m: float = Field(default=0.5, ge=0.1, le=20)
    """Side of a square carpet tile; 20 for a carpet in one piece."""


class PlywoodFloor(Section):
    """Sanded birch or poplar sheets, laid with their long sides together."""

    paint: Paint = Paint(reflectance=0.5, hue_deg=36, saturation=0.38)
    sheet_length_m: float = Field(default=2.44, ge=0.2, le=10)
    """Length of a sheet, from the middle of one seam to that of the next."""
    sheet_width_m: float = Field(default=1.22, ge=0.2, le=10)
    """Width of a sheet, from the middle of one seam to that of the next."""
    seam_m: float = Field(default=0.001, ge=0, le=0.01)
    """Width of the open seams between sheets."""
    variation: float = Field(default=0.15, ge=0, le=1)
    """Spread of reflectance over the grain and from sheet to sheet."""
    roughness: float = Field(default=0.55, ge=0.05, le=1)
    """Roughness of the surface; 0 is a mirror, 1 is matt."""


class PaperSheets(Section):
    """White sheets side by side with a small overlap, held along the seams by clear tape."""

    paint: Paint = Paint(reflectance=0.8, hue_deg=50, saturation=0.03)
    sheet_length_m: float = Field(default=0.841, ge=0.1, le=5)
    """Length of a sheet without its overlap, from the middle of one seam to that of the next; by default that of A1."""
    sheet_width_m: float = Field(default=0.594, ge=0.1, le=5)
    """Width of a sheet without its overlap, from the middle of one seam to that of the next; by default that of A1."""
    variation: float = Field(default=0.03, ge=0, le=0.5)
    """Spread of reflectance from sheet to sheet."""
    buckling: float = Field(default=0.4, ge=0, le=1)
    """Amount of waves and folds of the sheets; 0 for sheets that are glued flat."""
    tape_width_m: float = Field(default=0.019, ge=0, le=0.1)
    """Width of the clear tape on the seams; 0 for none."""
    roughness: float = Field(default=0.8, ge=0.05, le=1)
    """Roughness of the surface; 0 is a mirror, 1 is matt."""


class Vinyl(Section):
    """Cushioned sheet with a printed image of another floor, embossed and shiny."""

    paint: Paint = Paint(reflectance=0.4, hue_deg=32, saturation=0.3)
    print: Literal["planks", "terrazzo"] = "planks"
    """Printed pattern."""
    variation: float = Field(default=0.3, ge=0, le=1)
    """Contrast of the print, relative to the mean reflectance."""
    repeat_m: float = Field(default=0.18, ge=0.05, le=1)
    """Width of a printed plank, or ten times the largest chip of terrazzo."""
    roughness: float = Field(default=0.32, ge=0.05, le=1)
    """Roughness of the surface; 0 is a mirror, 1 is matt."""


class FloorLook(Section):
    """Material of the floor and its marks of use."""

    material: FloorName = "linoleum"
    """Material of the floor; only the section of this name is used."""
    yaw_deg: float = Field(default=0.0, ge=-360, le=360)
    """Rotation of the pattern under the arena."""
    dirt: float = Field(default=0.3, ge=0, le=1)
    """Amount of scuffs, dust and smudges; 0 for a new floor."""
    stains: float = Field(default=0.0, ge=0, le=1)
    """Amount of paler or darker patches of centimetres to decimetres and of rims of dried spills; 0 for none."""
    linoleum: Linoleum = Linoleum()
    ceramic_tile: CeramicTile = CeramicTile()
    parquet: Parquet = Parquet()
    concrete: Concrete = Concrete()
    carpet: Carpet = Carpet()
    plywood: PlywoodFloor = PlywoodFloor()
    paper_sheets: PaperSheets = PaperSheets()
    vinyl: Vinyl = Vinyl()
    image: ImageLook = ImageLook()
    """An image of the user on the floor."""
