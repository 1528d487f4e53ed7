"""Depth along the optical axis."""

import numpy as np

from blender_scenes.annotations.png import PngImage
from blender_scenes.annotations.seen import VisibleScene
from symolo.dataset.annotations import DEPTH_RANGE_M, DEPTH_UNIT_M


def depth(seen: VisibleScene) -> PngImage:
    """Return the depth (H, W) in units of 0.1 mm; 0 where there is no surface within 6.5 m."""
    within = seen.depth_m <= DEPTH_RANGE_M
    return np.where(within, np.rint(seen.depth_m / DEPTH_UNIT_M), 0).astype(np.uint16)
