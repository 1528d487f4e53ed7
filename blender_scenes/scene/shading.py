"""Surfaces as data: a small algebra of texture expressions, which `blender_side.shaders` turns into shader nodes.

Every texture is a function of the surface coordinates (u, v) of a mesh in metres, so that a grain of 2 mm is 2 mm on
every surface. Nothing here depends on Blender; equal numbers give equal expressions.
"""

from dataclasses import dataclass
from typing import Annotated, Literal, Union

from pydantic import Field

from configs.schema.appearance.look import Paint
from sensors.camera.colour import RGB, paint_rgb


@dataclass(frozen=True)
class Expression:
    """An expression; arithmetic on expressions and numbers builds larger ones."""

    def __add__(self, other: "Texture | float") -> "Arithmetic":
        return Arithmetic("add", as_texture(self), as_texture(other))

    def __sub__(self, other: "Texture | float") -> "Arithmetic":
        return Arithmetic("subtract", as_texture(self), as_texture(other))

    def __rsub__(self, other: float) -> "Arithmetic":
        return Arithmetic("subtract", as_texture(other), as_texture(self))

    def __mul__(self, other: "Texture | float") -> "Arithmetic":
        return Arithmetic("multiply", as_texture(self), as_texture(other))

    __radd__ = __add__
    __rmul__ = __mul__


@dataclass(frozen=True)
class Constant(Expression):
    """The same number everywhere."""

    value: float
    kind: Literal["number"] = "number"


@dataclass(frozen=True)
class Color(Expression):
    """The same colour everywhere, linear RGB."""

    rgb: RGB
    kind: Literal["color"] = "color"


def paint_color(paint: Paint, *, times: float = 1.0) -> Color:
    """Return the paint's colour at `times` its reflectance."""
    return Color(paint_rgb(paint, times=times))


@dataclass(frozen=True)
class SurfaceCoordinate(Expression):
    """One of the surface coordinates [m]."""

    axis: Literal["u", "v"]
    kind: Literal["coordinate"] = "coordinate"


@dataclass(frozen=True)
class NoiseTexture(Expression):
    """Fractal gradient noise, 0-1 with mean 0.5."""

    per_m: tuple[float, float]
    """Features per metre along u and v; unequal ones give grain."""
    offset: tuple[float, float]
    """Place of the surface in the endless pattern, in features."""
    octaves: float = 2.0
    gain: float = 0.5
    """Ratio of the amplitudes of an octave and the one before."""
    warp: float = 0.0
    turn_rad: float = 0.0
    """Angle of the grain from u towards v."""
    shift: "Texture | None" = None
    """Shift of the pattern in features, so that each tile or plank shows another part of it."""
    kind: Literal["noise"] = "noise"


@dataclass(frozen=True)
class Cells(Expression):
    """Voronoi cells: distance to the nearest point, to the nearest edge, or a random number per cell, all 0 to 1."""

    per_m: tuple[float, float]
    offset: tuple[float, float]
    value: Literal["distance", "edge", "random"] = "distance"
    kind: Literal["cells"] = "cells"


@dataclass(frozen=True)
class Tiles(Expression):
    """Rectangles in rows: 1 in the joint and 0 on the tile, or a random number from 0 to 1 per tile."""

    size_m: tuple[float, float]
    joint_m: float
    stagger: float
    """Shift of every second row, in tile lengths."""
    offset_m: tuple[float, float]
    """Offset of the surface within the infinite tiling [m]."""
    value: Literal["joint", "random"] = "joint"
    softness: float = 0.1
    """Share of half the joint's width, from each of its edges, over which the value rises from 0 to 1; with 1 it rises
    up to the middle."""
    kind: Literal["tiles"] = "tiles"


@dataclass(frozen=True)
class ImageTexture(Expression):
    """An image of the user, repeated along u and v; its colours are linear, white is 1."""

    sha256: str
    """SHA-256 of its file."""
    size_m: tuple[float, float]
    """Size of one copy."""
    at_m: tuple[float, float]
    """Lower left corner of one copy."""
    mean: RGB
    """Mean colour."""
    kind: Literal["image"] = "image"


@dataclass(frozen=True)
class Arithmetic(Expression):
    """An operation on two expressions at each point."""

    operation: Literal["add", "subtract", "multiply", "maximum", "sine"]
    a: "Texture"
    b: "Texture" = Constant(0.0)
    """Second operand; sine has none."""
    kind: Literal["arithmetic"] = "arithmetic"


@dataclass(frozen=True)
class Step(Expression):
    """Smooth rise from 0 at `low` to 1 at `high`."""

    of: "Texture"
    low: float
    high: float
    kind: Literal["step"] = "step"


@dataclass(frozen=True)
class Mix(Expression):
    """Linear mix of colours or numbers: `a` where `by` is 0, `b` where it is 1."""

    by: "Texture"
    a: "Texture"
    b: "Texture"
    kind: Literal["mix"] = "mix"


Texture = Annotated[
    Union[Constant, Color, SurfaceCoordinate, NoiseTexture, Cells, Tiles, ImageTexture, Arithmetic, Step, Mix],  # noqa: UP007 (forward references)
    Field(discriminator="kind"),
]


def as_texture(value: "Expression | float") -> "Texture":
    """Return the expression itself, or a number as an expression."""
    return value if isinstance(value, Expression) else Constant(float(value))  # pyright: ignore[reportReturnType]


def _is_false(value: bool) -> bool:  # noqa: FBT001 - pydantic calls it
    return not value


@dataclass(frozen=True)
class Surface:
    """A physically based surface: a dielectric, a metal, or a clear body."""

    name: str
    base_color: Texture
    """Diffuse reflectance, or the colour of the light that metal reflects or glass transmits."""
    roughness: Texture | float = 0.5
    height_m: Texture | None = None
    """Height of the relief; it changes the shading, not the geometry."""
    metallic: float = 0.0
    refractive_index: float = 1.45
    transmission: float = 0.0
    encloses_lamp: Annotated[bool, Field(exclude_if=_is_false)] = False
    """Whether it surrounds a lamp, as a hood does. Most light then falls on it at grazing angles, where gloss is much
    stronger than on average, so its gloss throws light on matt surfaces under every preset of light paths."""
