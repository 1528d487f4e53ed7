"""The one colour of a surface that is seen from far, for the light that it reflects to other surfaces."""

import math

from blender_scenes.scene.shading import (
    Arithmetic,
    Cells,
    Color,
    Constant,
    ImageTexture,
    Mix,
    NoiseTexture,
    Step,
    Surface,
    SurfaceCoordinate,
    Texture,
    Tiles,
)
from sensors.camera.colour import RGB

_CELL_MEANS = {"distance": 0.4, "edge": 0.2, "random": 0.5}


def typical_color(surface: Surface) -> RGB:
    """Return the base colour with every texture at its mean, and without joints; exact for a surface of one colour."""
    value = _typical(surface.base_color)
    return value if isinstance(value, tuple) else (value, value, value)


def matt_color(surface: Surface, base: RGB) -> RGB:
    """Return the colour of a matt surface that reflects about as much light as a surface by its gloss and its base.

    Gloss takes its share before the base, whose mean colour is `base`. The share is that of unpolarised light at 45
    degrees (Fresnel), the mean angle at which even light from all directions falls on a surface.
    """
    gloss = 0.0 if surface.metallic else _gloss(surface.refractive_index)
    red, green, blue = (gloss + (1 - gloss) * component for component in base)
    return red, green, blue


def _gloss(refractive_index: float) -> float:
    inside = math.sqrt(2 * refractive_index**2 - 1)
    across = ((inside - 1) / (inside + 1)) ** 2
    return 0.5 * (across + across**2)  # at 45 degrees, the share of light along the plane is the square of that across


def _typical(texture: Texture) -> RGB | float:
    match texture:
        case Constant(value) | Color(value):
            return value
        case NoiseTexture():
            return 0.5
        case Cells():
            return _CELL_MEANS[texture.value]
        case Tiles():
            return 0.5 if texture.value == "random" else 0.0
        case ImageTexture():
            return texture.mean
        case SurfaceCoordinate():
            return 0.05  # somewhere on the surface, away from its border
        case Step(of, low, high):
            share = min(max((_number(of) - low) / (high - low), 0.0), 1.0)
            return share * share * (3 - 2 * share)
        case Mix(by, a, b):
            return _between(min(max(_number(by), 0.0), 1.0), _typical(a), _typical(b))
        case Arithmetic():
            return _OPERATIONS[texture.operation](_number(texture.a), _number(texture.b))


def _number(texture: Texture) -> float:
    value = _typical(texture)
    return sum(value) / 3 if isinstance(value, tuple) else value


def _between(share: float, a: RGB | float, b: RGB | float) -> RGB | float:
    if isinstance(a, float) and isinstance(b, float):
        return a + share * (b - a)
    (r, g, b_), (s, h, c) = ((v if isinstance(v, tuple) else (v, v, v)) for v in (a, b))
    return r + share * (s - r), g + share * (h - g), b_ + share * (c - b_)


_OPERATIONS = {
    "add": lambda a, b: a + b,
    "subtract": lambda a, b: a - b,
    "multiply": lambda a, b: a * b,
    "maximum": max,
    "sine": lambda a, _: math.sin(a),
}
