"""The room around the arena: walls, what stands and hangs in it, and the window."""

from typing import Literal

from pydantic import Field

from configs.schema.base import Section
from configs.schema.paint import Paint


class FurnitureLook(Section):
    """How many pieces of each kind; 0 is none. Each has a size, a colour and a place of its own, drawn for the run.

    A piece that finds no free place is left out. They are scenery: the distance sensors and the wheels know nothing of
    them.
    """

    clearance_m: float = Field(default=0.6, ge=0.5, le=5)
    """No piece comes nearer to the arena's bounds, so that the robot has its way around the outermost obstacle."""
    tables: int = Field(default=0, ge=0, le=12)
    chairs: int = Field(default=0, ge=0, le=24)
    """Of four legs, most of them at a table."""
    office_chairs: int = Field(default=0, ge=0, le=12)
    """On five castors."""
    shelves: int = Field(default=0, ge=0, le=8)
    """With books and boxes, along the walls."""
    cartons: int = Field(default=0, ge=0, le=20)
    bags: int = Field(default=0, ge=0, le=20)
    bins: int = Field(default=0, ge=0, le=8)
    book_stacks: int = Field(default=0, ge=0, le=20)
    bottles: int = Field(default=0, ge=0, le=20)
    sheets: int = Field(default=0, ge=0, le=20)
    """Papers on the floor."""
    cables: int = Field(default=0, ge=0, le=12)
    """On the floor, each with a power strip."""
    posters: int = Field(default=0, ge=0, le=16)
    sockets: int = Field(default=0, ge=0, le=16)
    """In the walls."""
    door: bool = False
    radiator: bool = False
    """Below the window, where the sill is high enough for it."""


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
    furniture: FurnitureLook = FurnitureLook()


class WindowLook(Section):
    side: Literal["east", "north", "west", "south"] = "east"
    width_m: float = Field(default=2.4, ge=0.2, le=20)
    height_m: float = Field(default=1.5, ge=0.2, le=8)
    """Less where the ceiling is too low for it."""
    sill_m: float = Field(default=0.9, ge=0.0, le=3)
    panes: int = Field(default=3, ge=1, le=20)
    """Side by side, with a bar between two of them."""
    covering: Literal["none", "sheer", "blinds"] = "none"
    """A sheer curtain spreads all light, the sun's too; between the slats of blinds the sun comes in in stripes."""
    curtain_transmittance: float = Field(default=0.4, ge=0.02, le=0.9)
    """Share of the light that a sheer curtain lets through."""
    slat_tilt_deg: float = Field(default=25.0, ge=-60, le=60)
    """Of the blinds; positive where the outer edges are the higher ones, which lets a high sun in."""
