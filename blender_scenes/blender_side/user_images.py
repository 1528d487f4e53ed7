"""The user's files as Blender's images. We decode them, not Blender, so that all renderers see the same pixels."""

from pathlib import Path

import bpy
import numpy as np

from blender_scenes.render.user_image_reader import read_user_image
from configs.assets.images import read_image
from configs.assets.panoramas import read_panorama


class UserImages:
    """Blender's images by the SHA-256 of their files, each made once."""

    def __init__(self, folder: Path | None) -> None:
        self._folder = folder
        self._made: dict[str, bpy.types.Image] = {}

    def image(self, sha256: str) -> bpy.types.Image:
        """Return an 8-bit image; Cycles decodes sRGB."""
        if sha256 not in self._made:
            pixels = read_image(read_user_image(self._folder, sha256))
            self._made[sha256] = _image(sha256, pixels.astype(np.float32) / 255, "sRGB", in_floats=False)
        return self._made[sha256]

    def panorama(self, sha256: str) -> bpy.types.Image:
        if sha256 not in self._made:
            light = read_panorama(read_user_image(self._folder, sha256))
            self._made[sha256] = _image(sha256, light, "Linear Rec.709", in_floats=True)
        return self._made[sha256]


def _image(sha256: str, pixels: np.ndarray, color_space: str, *, in_floats: bool) -> bpy.types.Image:
    """Return pixels (H, W, 3) as an image of Blender, which begins with the lowest row and has an opacity."""
    height, width, _ = pixels.shape
    # A digest has 64 characters, and Blender keeps 63 bytes of a name.
    image = bpy.data.images.new(sha256[:32], width, height, alpha=False, float_buffer=in_floats)
    image.colorspace_settings.name = color_space
    opaque = np.ones((height, width, 4), np.float32)
    opaque[..., :3] = pixels[::-1]
    image.pixels.foreach_set(opaque.ravel())
    image.update()
    return image
