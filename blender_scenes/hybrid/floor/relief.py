"""How the light on the floor changes where its relief leans the normal.

With the vector irradiance E, the light on a floor with the unit normal n is E_x n_x + E_y n_y + E_z n_z, as long as no
light comes from below its horizon. The lean of light is E_x / E_z and E_y / E_z.
"""

from collections.abc import Sequence

import numpy as np

from symolo.core.arrays import Array, FloatImage

_TILT_RAD = np.radians(15.0)
_COSINE, _SINE = float(np.cos(_TILT_RAD)), float(np.sin(_TILT_RAD))
TILTS = (_SINE, 0.0, _COSINE), (-_SINE, 0.0, _COSINE), (0.0, _SINE, _COSINE), (0.0, -_SINE, _COSINE)
"""Unit normals of the floors whose light gives the lean."""
_MAX_LEAN = 50.0
"""Maximum lean, for light that comes from 1 degree above the floor."""


def lean(tilted: Sequence[FloatImage]) -> FloatImage:
    """Return the lean (N, N, 6) along x and along y of light with the ratios (N, N, 3) of `TILTS` to a level floor.

    E_x is half the difference of the light on floors tilted to both sides. The difference to a level floor would not
    do: light from below the horizon of a tilted floor counts as 0 there, and not as negative.
    """
    east, west, north, south = tilted
    leans = [(east - west) / (2 * _SINE), (north - south) / (2 * _SINE)]
    return np.clip(np.concatenate(leans, axis=-1), -_MAX_LEAN, _MAX_LEAN)


def lean_from(towards: FloatImage | Array) -> FloatImage:
    """Return the lean (..., 6) of light from directions (..., 3) above the floor, as `lean` finds it."""
    up = towards[..., 2]
    ratios = (np.maximum(towards @ np.asarray(tilt, towards.dtype), 0) / up for tilt in TILTS)
    return lean([np.repeat(ratio[..., None], 3, axis=-1).astype(np.float32) for ratio in ratios])


def lean_without(leans: FloatImage, taken: Sequence[tuple[FloatImage, FloatImage]]) -> FloatImage:
    """Return the lean (H, W, 6) of light from which parts are taken.

    Args:
        leans: Lean (H, W, 6) of all light.
        taken: Parts (H, W, 3) of the light, which are less than 1 together, and the lean (6,) or (H, W, 6) of each.
    """
    both = [(np.concatenate([part, part], axis=-1), its_lean) for part, its_lean in taken]
    rest = leans - sum(part * its_lean for part, its_lean in both)
    return np.clip(rest / (1 - sum(part for part, _ in both)), -_MAX_LEAN, _MAX_LEAN)


def shading(normal: FloatImage, leans: FloatImage) -> FloatImage:
    """Return the light (H, W, 3) on floors with normals (H, W, 3), as a share of that on a level floor."""
    return np.maximum(normal[..., 2:] + normal[..., :1] * leans[..., :3] + normal[..., 1:2] * leans[..., 3:], 0)
