"""The reflectance of a surface at each of its points."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from blender_scenes.scene.shading import ImageTexture, Mix, Surface, Texture
from blender_scenes.scene.typical import typical_color
from configs.assets.images import LINEAR
from symolo.core.arrays import Array

ReadImage = Callable[[str], NDArray[np.uint8]]
"""Function from the SHA-256 of an image to its sRGB pixels (H, W, 3)."""


def albedo(surface: Surface, uv_m: Array, pixels: ReadImage) -> Array:
    """Return the reflectance (N, 3) at surface coordinates (N, 2) [m]: pixels of images, else a typical colour."""
    return _colors(surface.base_color, uv_m, pixels)


def _colors(texture: Texture, uv_m: Array, pixels: ReadImage) -> Array:
    match texture:
        case ImageTexture():
            return _looked_up(texture, uv_m, pixels(texture.sha256))
        case Mix(by, a, b) if _has_image(texture):
            share = np.clip(np.array(typical_color(Surface("", by))), 0, 1)
            below, above = _colors(a, uv_m, pixels), _colors(b, uv_m, pixels)
            return below + share * (above - below)
        case _:
            return np.broadcast_to(np.array(typical_color(Surface("", texture))), (len(uv_m), 3))


def _has_image(texture: Texture) -> bool:
    return isinstance(texture, ImageTexture) or (
        isinstance(texture, Mix) and (_has_image(texture.a) or _has_image(texture.b))
    )


def _looked_up(texture: ImageTexture, uv_m: Array, image: NDArray[np.uint8]) -> Array:
    """Return the linear colour of the nearest pixel of the repeated image."""
    height, width, _ = image.shape
    share = ((uv_m - np.array(texture.at_m)) / np.array(texture.size_m)) % 1.0
    column = np.minimum((share[:, 0] * width).astype(np.intp), width - 1)
    row = height - 1 - np.minimum((share[:, 1] * height).astype(np.intp), height - 1)
    return LINEAR[image[row, column]]
