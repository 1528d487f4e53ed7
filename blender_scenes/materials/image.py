"""A picture of the user's own, laid side by side over a surface."""

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.scene.shading import Color, Constant, ImageTexture, Mix, Surface
from configs.schema.asset import Asset, ImageLook
from configs.schema.floors import FloorLook

_BLACK = Color((0.0, 0.0, 0.0))


def image_floor(look: FloorLook, patch: SurfacePatch) -> Surface:
    """The floor's own picture.

    Raises:
        ValueError: The look names none.
    """
    if look.image.file is None:
        raise ValueError("the floor is an image, and none is named")
    return image(look.image, look.image.file, patch)


def image(config: ImageLook, file: Asset, patch: SurfacePatch) -> Surface:
    """The picture at its size in metres; what it shows of gloss or depth is painted, not there."""
    size = config.width_m, config.width_m * file.height_px / file.width_px
    picture = ImageTexture(file.sha256, size, (config.right_m, config.up_m), file.mean_rgb)
    return Surface(patch.name, Mix(Constant(config.white_reflectance), _BLACK, picture), roughness=config.roughness)
