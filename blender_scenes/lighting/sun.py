"""Direct sun through the window."""

import math

from blender_scenes.lighting.base import Lights
from blender_scenes.rooms.base import RoomModel
from blender_scenes.scene.description import Point3, Sun
from configs.schema.appearance.look import LookConfig
from sensors.camera.colour import light_rgb, scaled


def sun(look: LookConfig, room: RoomModel) -> Lights:
    """Return the sun; none where it gives no light or a sheer curtain scatters it."""
    config = look.sun
    if config.illuminance_klx == 0 or look.window.covering == "sheer":
        return Lights()
    irradiance = scaled(light_rgb(config.color_temperature_K), config.illuminance_klx)
    return Lights(suns=(Sun(towards_sun(look, room), irradiance, math.radians(config.angular_diameter_deg)),))


def towards_sun(look: LookConfig, room: RoomModel) -> Point3:
    """Return the unit vector to the sun; its azimuth counts from the window's outward normal."""
    config = look.sun
    outward = math.atan2(-room.window.inward[1], -room.window.inward[0])
    azimuth, elevation = outward + math.radians(config.azimuth_from_window_deg), math.radians(config.elevation_deg)
    return (math.cos(elevation) * math.cos(azimuth), math.cos(elevation) * math.sin(azimuth), math.sin(elevation))
