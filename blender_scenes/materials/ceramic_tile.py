"""Glazed ceramic tiles with grouted joints."""

from blender_scenes.colour import paint_color
from blender_scenes.materials.base import Patch
from blender_scenes.shading import Mix, Noise, Surface, Tiles
from configs.schema.look import FloorLook


def ceramic_tile(look: FloorLook, patch: Patch) -> Surface:
    """Square tiles in straight courses, each of a slightly different batch, joints lower and rough."""
    own = look.ceramic_tile
    pitch = own.size_m
    offset = patch.offset("courses")
    joint = Tiles((pitch, pitch), own.joint_width_m, 0.0, offset, "joint")
    batch = Tiles((pitch, pitch), own.joint_width_m, 0.0, offset, "random")
    cloud = Noise((9.0, 9.0), patch.offset("clouds"), octaves=4)
    tile = Mix(
        0.5 * batch + 0.5 * cloud,
        paint_color(own.paint, times=1 - own.variation),
        paint_color(own.paint, times=1 + own.variation),
    )
    return Surface(
        patch.name,
        Mix(joint, tile, paint_color(own.joint)),
        roughness=own.roughness + 0.6 * joint,
        height_m=-0.0008 * joint,
    )
