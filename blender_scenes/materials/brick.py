"""Bare brickwork."""

from blender_scenes.materials.base import SurfacePatch
from blender_scenes.materials.marks.patterns import shaded, specks
from blender_scenes.scene.shading import Mix, NoiseTexture, Surface, Tiles, paint_color
from configs.schema.appearance.look import LookConfig


def brick(look: LookConfig, patch: SurfacePatch) -> Surface:
    """Return courses that begin at the floor: bricks of different shades, and lighter, sandy mortar, set back."""
    config = look.brick
    size = config.length_m + config.joint_m, config.height_m + config.joint_m
    offset = size[0] * patch.draw("first brick"), 0.0
    joint = Tiles(size, config.joint_m, 0.5, offset, "joint", softness=0.35)
    fired = Tiles(size, config.joint_m, 0.5, offset, "random")
    scorch = NoiseTexture((9.0, 16.0), patch.offset("scorch"), octaves=4, gain=0.6, shift=40 * fired)
    grain = NoiseTexture((420.0, 420.0), patch.offset("grain"), octaves=3, gain=0.65)
    tone = 0.45 * fired + 0.35 * scorch + 0.2 * grain
    clay = shaded(tone, config.paint, config.variation)
    clay = Mix(0.6 * specks(patch, "pits", size_m=0.002, share=0.5), clay, paint_color(config.paint, times=0.35))
    mortar = shaded(grain, config.joint, 0.25)
    return Surface(
        patch.name, Mix(joint, clay, mortar), roughness=0.9, height_m=0.0006 * grain + 0.0005 * scorch - 0.004 * joint
    )
