"""wood."""

from blender_scenes.materials.base import Patch
from blender_scenes.shading import Color, Surface
from configs.schema.look import LookConfig


def wood(look: LookConfig, patch: Patch) -> Surface:
    return Surface(patch.name, Color((0.5, 0.5, 0.5)))
