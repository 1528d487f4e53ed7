"""The room around the arena: walls, furniture and window."""

from typing import Literal

from pydantic import Field

from configs.schema.appearance.paint import Paint
from configs.schema.base import Section


class FurnitureLook(Section):
    """Number of pieces of each kind, each with a size, a colour and a place that are drawn for the run.

    A piece without a free place is left out. Furniture is scenery: distance sensors and wheels ignore it.
    """

    clearance_m: float = Field(default=0.6, ge=0.5, le=5)
    """Smallest distance of pieces from the arena's bounds, so that the robot has room around the outermost obstacle."""
    tables: int = Field(default=0, ge=0, le=12)
    """Number of tables."""
    chairs: int = Field(default=0, ge=0, le=24)
    """Number of chairs with four legs, most of them at a table."""
    office_chairs: int = Field(default=0, ge=0, le=12)
    """Number of chairs on five castors."""
    shelves: int = Field(default=0, ge=0, le=8)
    """Number of shelves with books and boxes, along the walls."""
    cartons: int = Field(default=0, ge=0, le=20)
    """Number of cartons on the floor."""
    bags: int = Field(default=0, ge=0, le=20)
    """Number of bags on the floor."""
    bins: int = Field(default=0, ge=0, le=8)
    """Number of waste bins."""
    book_stacks: int = Field(default=0, ge=0, le=20)
    """Number of stacks of books."""
    bottles: int = Field(default=0, ge=0, le=20)
    """Number of bottles."""
    sheets: int = Field(default=0, ge=0, le=20)
    """Number of sheets of paper on the floor."""
    cables: int = Field(default=0, ge=0, le=12)
    """Number of cables on the floor, each with a power strip."""
    posters: int = Field(default=0, ge=0, le=16)
    """Number of posters on the walls."""
    sockets: int = Field(default=0, ge=0, le=16)
    """Number of sockets in the walls."""
    door: bool = False
    """Whether one wall has a door."""
    radiator: bool = False
    """Whether there is a radiator below the window, if the sill is high enough."""


class RoomLook(Section):
    """The room around the arena, a box with margins around the arena's bounds."""

    margin_east_m: float = Field(default=2.0, ge=1.3, le=30)
    """Distance from the arena's bounds to the east wall (+x of W) [m]."""
    margin_north_m: float = Field(default=1.8, ge=1.3, le=30)
    """Distance from the arena's bounds to the north wall (+y of W) [m]."""
    margin_west_m: float = Field(default=2.2, ge=1.3, le=30)
    """Distance from the arena's bounds to the west wall (-x of W) [m]."""
    margin_south_m: float = Field(default=1.6, ge=1.3, le=30)
    """Distance from the arena's bounds to the south wall (-y of W) [m]."""
    height_m: float = Field(default=2.8, ge=2, le=10)
    """Height of the ceiling [m]."""
    wall: Paint = Paint(reflectance=0.7, hue_deg=48, saturation=0.08)
    skirting: Paint = Paint(reflectance=0.45, hue_deg=30, saturation=0.3)
    skirting_height_m: float = Field(default=0.07, ge=0.01, le=0.5)
    """Height of the skirting boards [m]."""
    furniture: FurnitureLook = FurnitureLook()


class WindowLook(Section):
    """The window of the room."""

    side: Literal["east", "north", "west", "south"] = "east"
    """Wall of the window; east is +x of W, north +y."""
    width_m: float = Field(default=2.4, ge=0.2, le=20)
    """Width of the window [m]."""
    height_m: float = Field(default=1.5, ge=0.2, le=8)
    """Height of the window; less if the ceiling is too low."""
    sill_m: float = Field(default=0.9, ge=0.0, le=3)
    """Height of the sill above the floor [m]."""
    panes: int = Field(default=3, ge=1, le=20)
    """Number of panes side by side, with bars between them."""
    covering: Literal["none", "sheer", "blinds"] = "none"
    """Covering: a sheer curtain diffuses all light, also that of the sun; blinds admit the sun in stripes."""
    curtain_transmittance: float = Field(default=0.4, ge=0.02, le=0.9)
    """Share of the light that a sheer curtain lets through."""
    slat_tilt_deg: float = Field(default=25.0, ge=-60, le=60)
    """Tilt of the slats; positive if the outer edges are higher, which lets a high sun in."""
