"""Instance ids."""

import numpy as np

from blender_scenes.annotations.png import Picture
from blender_scenes.annotations.seen import Seen


def instance(seen: Seen) -> Picture:
    """(H, W), the ids of the table; 0 where no surface is met."""
    return seen.instance.astype(np.uint16)
