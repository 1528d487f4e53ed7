"""The sky outside, and its light through the window."""

import math

import numpy as np

from blender_scenes.colour import LUMINANCE
from blender_scenes.description import Panel, Sky
from blender_scenes.lighting.base import Lights
from blender_scenes.lighting.panoramas import CEILING, MEAN_COLOR
from blender_scenes.rooms.base import Room
from configs.schema.look import LookConfig


def daylight(look: LookConfig, room: Room) -> Lights:
    """The panorama scaled to the look's mean luminance; a panel of its mean colour shines from each window.

    About half of what a window sees is sky, the rest houses and ground of a third of its luminance.
    """
    own = look.sky
    mean = np.array(MEAN_COLOR[own.panorama])
    gain = own.luminance_kcd_m2 / float(mean @ LUMINANCE)
    sky = Sky(own.panorama, math.radians(own.yaw_deg), gain, CEILING, own.saturation)
    if own.luminance_kcd_m2 == 0:
        return Lights(skies=(sky,))
    grey = float(mean @ LUMINANCE)
    r, g, b = (0.65 * gain * (grey + own.saturation * (mean - grey))).tolist()
    window = room.window
    panel = Panel(
        "window",
        tuple(np.subtract(window.center, np.multiply(window.inward, room.wall_depth_m)).tolist()),
        window.right,
        window.up,
        window.width_m,
        window.height_m,
        (r, g, b),
        mirrored=False,
    )
    return Lights(panels=(panel,), skies=(sky,))
