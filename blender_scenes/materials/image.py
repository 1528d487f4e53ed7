"""An image of the user, repeated over a surface."""

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.scene.shading import Color, Constant, ImageTexture, Mix, Surface
from configs.schema.appearance.asset import Asset, ImageLook

_BLACK = Color((0.0, 0.0, 0.0))


def repeated_image(config: ImageLook, file: Asset, patch: SurfacePatch) -> Surface:
    """Return the image at its size in metres, as a flat surface of one gloss."""
    size = config.width_m, config.width_m * file.height_px / file.width_px
    texture = ImageTexture(file.sha256, size, (config.right_m, config.up_m), file.mean_rgb)
    return Surface(patch.name, Mix(Constant(config.white_reflectance), _BLACK, texture), roughness=config.roughness)
