"""Surface normals in the camera's frame."""

import numpy as np

from blender_scenes.annotations.png import PngImage
from blender_scenes.annotations.seen import VisibleScene
from symolo.dataset.annotations import NORMAL_SCALE, NORMAL_ZERO


def normals(seen: VisibleScene) -> PngImage:
    """Return (H, W, 3): x, y, z in C as 32768 + 32767 n, towards the camera; 0 where there is no surface."""
    normal_C = seen.passes.normal_W @ seen.X_WC[:3, :3]
    met = seen.passes.mesh[..., None] > 0
    return np.where(met, NORMAL_ZERO + np.rint(NORMAL_SCALE * normal_C), 0).astype(np.uint16)
