"""Category ids."""

import numpy as np

from blender_scenes.annotations.png import PngImage
from blender_scenes.annotations.seen import VisibleScene


def semantic(seen: VisibleScene) -> PngImage:
    """Return the ids (H, W) of the categories."""
    return seen.category.astype(np.uint8)
