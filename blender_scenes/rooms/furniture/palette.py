"""Colours of furniture, as reflectance, hue [deg] and saturation."""

import numpy as np

from blender_scenes.rooms.furniture.base import between, one_of
from configs.schema.appearance.paint import Paint

_WOODS = ((0.45, 34.0, 0.45), (0.32, 30.0, 0.5), (0.16, 24.0, 0.5), (0.6, 40.0, 0.25))
_BOARDS = (*_WOODS, (0.75, 50.0, 0.02), (0.55, 45.0, 0.04), (0.3, 210.0, 0.05))
_FRAMES = ((0.04, 0.0, 0.0), (0.25, 210.0, 0.05), (0.5, 210.0, 0.03), (0.7, 50.0, 0.02), (0.12, 215.0, 0.6))
_HUES = (5.0, 15.0, 28.0, 45.0, 95.0, 150.0, 190.0, 208.0, 218.0, 228.0, 345.0)


def board(rng: np.random.Generator) -> Paint:
    """Draw the colour of veneered or laminated board."""
    return _paint(one_of(rng, _BOARDS))


def frame(rng: np.random.Generator) -> Paint:
    """Draw the colour of powder-coated steel."""
    return _paint(one_of(rng, _FRAMES))


def cloth(rng: np.random.Generator) -> Paint:
    """Draw the colour of bags and seats, which are dark more often than bright."""
    return _dyed(rng, float(np.exp(between(rng, np.log(0.03), np.log(0.35)))))


def print_color(rng: np.random.Generator) -> Paint:
    """Draw the colour of printed covers and posters."""
    return _dyed(rng, between(rng, 0.06, 0.55))


def _dyed(rng: np.random.Generator, reflectance: float) -> Paint:
    """Draw a dyed colour; a light one is pale, because no pigment reflects half of all light in one colour."""
    hue, strength = one_of(rng, _HUES), between(rng, 0.1, 0.9)
    return Paint(reflectance=reflectance, hue_deg=hue, saturation=strength * (1.0 - 1.2 * reflectance))


def _paint(numbers: tuple[float, float, float]) -> Paint:
    reflectance, hue, saturation = numbers
    return Paint(reflectance=reflectance, hue_deg=hue, saturation=saturation)
