"""Category ids."""

import numpy as np

from blender_scenes.annotations.png import Picture
from blender_scenes.annotations.seen import Seen


def semantic(seen: Seen) -> Picture:
    """(H, W), the ids of the categories."""
    return seen.category.astype(np.uint8)
