"""A cable on the floor with a power strip at its end."""

from dataclasses import dataclass

import numpy as np

from blender_scenes.materials.fittings import moulded
from blender_scenes.rooms.furniture.base import Piece, between
from blender_scenes.scene.meshes import block
from blender_scenes.scene.solids import joined, moved, pipe
from sensors.camera.colour import RGB

_STRIP_M = (0.055, 0.28, 0.04)
_SOCKETS = 3


@dataclass(frozen=True)
class Cable:
    """Shape and colour of a cable."""

    length_m: float
    """Straight distance from end to end."""
    radius_m: float
    waves_m: tuple[float, ...]
    """Amplitudes [m] of one, two, three ... half waves to the side."""
    white: bool
    """Whether cable and power strip are white; otherwise they are black."""


def cable(name: str, spec: Cable) -> Piece:
    """Return a cable along y with a power strip at its front end."""
    share = np.linspace(0.0, 1.0, 40)
    aside = sum(a * np.sin(np.pi * (i + 1) * share) for i, a in enumerate(spec.waves_m))
    y = spec.length_m * (share - 0.5)
    path = [(float(a), float(b), spec.radius_m) for a, b in zip(np.broadcast_to(aside, share.shape), y, strict=True)]
    _, length, height = _STRIP_M
    front = -0.5 * spec.length_m - 0.5 * length
    parts = [pipe("cable", path, spec.radius_m, f"{name}_sheath")]
    parts.append(block("strip", (0, front, 0.5 * height), _STRIP_M, f"{name}_sheath"))
    for i in range(_SOCKETS):
        at = (0, front + (i - 1) * 0.07, height)
        parts.append(block("socket", at, (0.04, 0.04, 0.001), f"{name}_holes"))
    parts = [moved(part, (0.0, 0.5 * length, 0.0)) for part in parts]
    color: RGB = (0.7, 0.7, 0.68) if spec.white else (0.03, 0.03, 0.03)
    surfaces = moulded(f"{name}_sheath", color, 0.45), moulded(f"{name}_holes", (0.1, 0.1, 0.1), 0.5)
    return Piece(joined(name, parts), surfaces, spec)


def drawn_cable(name: str, rng: np.random.Generator) -> Piece:
    spec = Cable(
        length_m=between(rng, 0.5, 1.4),
        radius_m=between(rng, 0.003, 0.0045),
        waves_m=tuple(between(rng, -0.12, 0.12) / (i + 1) for i in range(4)),
        white=bool(rng.uniform() < 0.5),
    )
    return cable(name, spec)
