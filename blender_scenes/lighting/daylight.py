"""The sky outside, seen through the window."""

import math

from blender_scenes.description import Portal, Sky
from blender_scenes.lighting.base import Lights
from blender_scenes.rooms.base import Room
from configs.schema.look import LookConfig


def daylight(look: LookConfig, room: Room) -> Lights:
    window = room.window
    portal = Portal("window", window.center, window.right, window.up, window.width_m, window.height_m)
    sky = Sky(look.sky.panorama, math.radians(look.sky.yaw_deg), look.sky.luminance_kcd_m2)
    return Lights(portals=(portal,), skies=(sky,))
