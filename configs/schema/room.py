"""The room around the arena: walls, furniture and window."""

from typing import Literal

from pydantic import Field

from configs.schema.base import Section
from configs.schema.paint import Paint


class FurnitureLook(Section):
    """Number of pieces of each kind, each with a size, a colour and a place that are drawn for the run.

    A piece without a free place is left out. Furniture is scenery: distance sensors and wheels ignore it.
    """

    clearance_m: float = Field(default=0.6, ge=0.5, le=5)
    """Smallest distance of pieces from the arena's bounds, so that the robot has room around the outermost obstacle."""
    tables: int = Field(default=0, ge=0, le=12)
    chairs: int = Field(default=0, ge=0, le=24)
    """Number of chairs with four legs, most of them at a table."""
    office_chairs: int = Field(default=0, ge=0, le=12)
    """Number of chairs on five castors."""
    shelves: int = Field(default=0, ge=0, le=8)
    """Number of shelves with books and boxes, along the walls."""
    cartons: int = Field(default=0, ge=0, le=20)
    bags: int = Field(default=0, ge=0, le=20)
    bins: int = Field(default=0, ge=0, le=8)
    book_stacks: int = Field(default=0, ge=0, le=20)
    bottles: int = Field(default=0, ge=0, le=20)
    sheets: int = Field(default=0, ge=0, le=20)
    """Number of sheets of paper on the floor."""
    cables: int = Field(default=0, ge=0, le=12)
    """Number of cables on the floor, each with a power strip."""
    posters: int = Field(default=0, ge=0, le=16)
    sockets: int = Field(default=0, ge=0, le=16)
    """Number of sockets in the walls."""
    door: bool = False
    radiator: bool = False
    """Whether there is a radiator below the window, if the sill is high enough."""


class RoomLook(Section):
    """The room around the arena, a box with margins around the arena's bounds."""

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
    """Height of the window; less if the ceiling is too low."""
    sill_m: float = Field(default=0.9, ge=0.0, le=3)
    panes: int = Field(default=3, ge=1, le=20)
    """Number of panes side by side, with bars between them."""
    covering: Literal["none", "sheer", "blinds"] = "none"
    """Covering: a sheer curtain diffuses all light, also that of the sun; blinds admit the sun in stripes."""
    curtain_transmittance: float = Field(default=0.4, ge=0.02, le=0.9)
    """Share of the light that a sheer curtain lets through."""
    slat_tilt_deg: float = Field(default=25.0, ge=-60, le=60)
    """Tilt of the slats; positive if the outer edges are higher, which lets a high sun in."""
