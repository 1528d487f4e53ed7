"""Floor that the camera sees and on which nothing stands."""

import numpy as np

from blender_scenes.annotations.instances import ON_THE_FLOOR
from blender_scenes.annotations.png import PngImage
from blender_scenes.annotations.seen import VisibleScene
from symolo.dataset.annotations import CATEGORIES


def free_floor(seen: VisibleScene) -> PngImage:
    """Return (H, W): 255 where floor or line is visible, 0 elsewhere."""
    free = [CATEGORIES.index(category) for category in CATEGORIES if category in ON_THE_FLOOR]
    return np.where(np.isin(seen.category, free), 255, 0).astype(np.uint8)
