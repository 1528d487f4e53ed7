"""The light on a surface: direct light of panels and sun, shadows of the sun only, and even indirect light.

Illuminances are in kilolux per linear component; radiances are in 1000 cd/m2.
"""

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from blender_scenes.lighting.panoramas import mean_of_sky
from blender_scenes.preview.triangles import Triangles
from blender_scenes.scene.description import LightPanel, Sky, Sun
from sensors.camera.colour import LUMINANCE
from symolo.core.arrays import Array

Floats = NDArray[np.float32]
"""Single precision halves the time."""


def from_panels(panels: Sequence[LightPanel], points: Floats, normals: Floats) -> Floats:
    """Return the illuminance (3, N) of surfaces at points (3, N) with unit normals (3, N).

    A panel counts as a disc of its area A in its middle: L A cos cos / (r2 + A / pi), exact on the disc's axis at any
    distance r and so never more than pi L; far away it is the inverse square of `lighting.illuminance`.
    """
    total: Floats = np.zeros_like(points)
    for panel in panels:
        area = panel.width_m * panel.height_m
        x, y, z = (center - component for center, component in zip(panel.center, points, strict=True))
        squared = x * x + y * y + z * z
        leaving = np.cross(panel.right, panel.up).astype(np.float32)
        out = np.maximum(-_dot(leaving, (x, y, z)), 0)
        into = np.maximum(_dot(normals, (x, y, z)), 0)
        share = out * into / (np.maximum(squared, 1e-9) * (squared + area / np.pi))
        for channel, radiance in enumerate(panel.radiance):
            total[channel] += (area * radiance) * share
    return total


def from_sun(sun: Sun, normals: Floats, lit: NDArray[np.bool_]) -> Floats:
    """Return the illuminance (3, N) of surfaces with unit normals (3, N), where `lit` (N,), and 0 elsewhere."""
    cosine: Floats = np.maximum(_dot(np.array(sun.towards, np.float32), normals), 0)
    return np.outer(sun.irradiance, np.where(lit, cosine, 0)).astype(np.float32)


def _dot(a: Iterable[Floats], b: Iterable[Floats]) -> Floats:
    """Return dot products of vectors (3, N), which is several times faster than for vectors (N, 3)."""
    (ax, ay, az), (bx, by, bz) = a, b
    return ax * bx + ay * by + az * bz


def from_all_around(panels: Sequence[LightPanel], scene: Triangles, colors: Array) -> Array:
    """Return the illuminance (3,) by light between the scene's surfaces, which is taken to be the same everywhere.

    It is that of an integrating sphere: flux / area x rho / (1 - rho), with the area of the box around the scene and
    the mean reflectance rho of its faces, whose colours are (T, 3).
    """
    if not len(scene.corners):
        return np.zeros(3)
    flux = sum((np.pi * p.width_m * p.height_m * np.array(p.radiance) for p in panels), start=np.zeros(3))
    everything = scene.corners.reshape(-1, 3)
    x, y, z = everything.max(axis=0) - everything.min(axis=0)
    # Light is reflected again and again: rho + rho^2 + ... = rho / (1 - rho).
    rho = np.average(colors, axis=0, weights=np.linalg.norm(scene.crosses, axis=1))
    return flux / (2 * (x * y + y * z + z * x)) * rho / (1 - rho)


def from_sky(sky: Sky) -> Array:
    """Return the mean radiance (3,) of the sky; the panorama itself is a file of Blender."""
    mean = np.array(mean_of_sky(sky))
    grey = mean @ LUMINANCE
    return sky.gain * (grey + sky.saturation * (mean - grey))
