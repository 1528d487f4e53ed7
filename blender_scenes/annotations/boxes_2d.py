"""Boxes in the image: around the visible part of a wall or obstacle, and around all of it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from blender_scenes.annotations.job import Solid
from blender_scenes.annotations.seen import VisibleScene
from blender_scenes.annotations.silhouette import reaches_beyond
from symolo.dataset.annotations import PixelBox, pixel_box


@dataclass(frozen=True)
class Box2D:
    bbox: PixelBox
    """Around what is seen."""
    area: int
    """Pixels in which it is seen."""
    amodal_bbox: PixelBox
    """Around all of it that lies within the picture, hidden or not."""
    amodal_area: int
    """Pixels in which it would be seen if nothing stood before it."""
    visible_fraction: float
    """`area` by `amodal_area`."""
    truncated: bool
    """Whether it goes on beyond the picture's border."""


def box_2d(seen: VisibleScene, solid: Solid, whole: NDArray[np.bool_]) -> Box2D:
    """Return the boxes of a wall or obstacle whose silhouette `whole` (H, W) is not empty."""
    visible = seen.instance == solid.instance_id
    area, amodal_area = int(visible.sum()), int(whole.sum())
    return Box2D(
        bbox=pixel_box(visible),
        area=area,
        amodal_bbox=pixel_box(whole),
        amodal_area=amodal_area,
        visible_fraction=round(area / amodal_area, 6),
        truncated=reaches_beyond(seen, solid),
    )
