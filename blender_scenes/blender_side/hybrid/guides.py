"""What the surfaces of an image say about its light of few pixels: which pixels show floor, and how to upsample it."""

import cv2
import numpy as np

from blender_scenes.blender_side.hybrid.materials import COVER
from blender_scenes.blender_side.hybrid.scenes import Passes
from blender_scenes.hybrid.guided_filter import carried_from_around
from blender_scenes.hybrid.upsampling import reduced, upsampled
from symolo.core.arrays import FloatImage

ROUGHNESS = "roughness"
"""Name of the floor's roughness among the passes of the surfaces."""
WHOLLY = 0.99
"""Cover from which on a pixel counts as one that shows nothing but floor."""
_MIN_SHARE = np.float32(0.01)
"""Share of other things in a pixel below which their normal is not known."""
_BESIDE_PX = 2
"""Distance from the floor up to which light on other things does not count in their mean."""
_UP = np.array((0.0, 0.0, 1.0), np.float32)


def is_floor(seen: Passes, times: int) -> FloatImage:
    """Return (h, w, 1): 1 where a pixel of light, shared by `times` pixels each way, shows only floor; 0 elsewhere."""
    return (reduced(seen[COVER][..., :1], times) > WHOLLY).astype(np.float32)


def without_floor(light: FloatImage, passes: Passes, cover: FloatImage) -> FloatImage:
    """Return the light (h, w, 3) on other things than the floor, also where a pixel shows both.

    It does so by its own rays, or by the `cover` (h, w, 1) of the surfaces, which guided the denoiser.

    Such a pixel has a mean of the light on both. Multiplied by the colour of a shaded face in front of a bright floor,
    it would be a line at the edge of the face that is brighter than both.
    """
    return carried_from_around(light, (np.maximum(passes[COVER][..., :1], cover) == 0).astype(np.float32))


def weight_of_things(passes: Passes) -> FloatImage:
    """Return how much the light (h, w, 3) on other things than the floor counts in their mean: what they reflect.

    It is 0 beside the floor, where the denoiser mixes the light on both.
    """
    shows_things = (passes[COVER][..., 0] == 0).astype(np.uint8)
    inside = cv2.erode(shows_things, np.ones((2 * _BESIDE_PX + 1,) * 2, np.uint8))
    return passes["DiffCol"] * inside[..., None]


def normal_without_floor(seen: Passes) -> FloatImage:
    """Return the normals (H, W, 3) of other things than the floor; that of the floor where there is nothing else."""
    cover = seen[COVER][..., :1]
    rest = seen["Normal"] - cover * _UP
    length = np.linalg.norm(rest, axis=-1, keepdims=True)
    return np.where((cover > 0) & (length > _MIN_SHARE), rest / np.maximum(length, _MIN_SHARE), seen["Normal"])


def upsampled_light(low: FloatImage, seen: Passes) -> FloatImage:
    """Return (H, W, K - 5) for the pixels of the surfaces, from (h, w, K).

    The last twelve channels are the light on other things than the floor (3), and four slopes, four values and their
    roughness; for floor the values follow its roughness.
    """
    nearness = 1 / np.maximum(seen["Depth"], 1e-3)
    alone, thing_light, lines = np.split(low, [-12, -9], axis=-1)
    thing_light = upsampled(thing_light, nearness, normal_without_floor(seen))
    values = upsampled(np.concatenate([alone, lines], axis=-1), nearness, seen["Normal"])
    alone, slope, value, roughness = np.split(values, [-9, -5, -1], axis=-1)
    rougher = np.where(seen[COVER][..., :1] > 0, seen[ROUGHNESS] - roughness, 0)
    return np.concatenate([alone, thing_light, value + slope * rougher], axis=-1)
