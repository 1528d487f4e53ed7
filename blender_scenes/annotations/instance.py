"""Instance ids."""

import numpy as np

from blender_scenes.annotations.png import PngImage
from blender_scenes.annotations.seen import VisibleScene


def instance(seen: VisibleScene) -> PngImage:
    """Return the ids (H, W) of the instances; 0 where there is no surface."""
    return seen.instance.astype(np.uint16)
