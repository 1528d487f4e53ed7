"""An image of the user, repeated over the floor."""

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.materials.image import repeated_image
from blender_scenes.scene.shading import Surface
from configs.schema.appearance.floors import FloorLook


def image(look: FloorLook, patch: SurfacePatch) -> Surface:
    """Return the look's image as a floor.

    Raises:
        ValueError: The look names no image.
    """
    if look.image.file is None:
        raise ValueError("the floor is an image, and none is named")
    return repeated_image(look.image, look.image.file, patch)
