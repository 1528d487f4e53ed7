"""Instance ids."""

import numpy as np

from blender_scenes.annotations.png import PngImage
from blender_scenes.annotations.seen import VisibleScene


def instance(seen: VisibleScene) -> PngImage:
    """(H, W), the ids of the table; 0 where no surface is met."""
    return seen.instance.astype(np.uint16)
