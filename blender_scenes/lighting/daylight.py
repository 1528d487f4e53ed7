"""The sky outside, and its light through the window."""

import math

import numpy as np

from blender_scenes.lighting.base import Lights
from blender_scenes.lighting.panoramas import mean_color
from blender_scenes.lighting.sun import towards_sun
from blender_scenes.lighting.window_covering import CURTAIN_M, curtain
from blender_scenes.rooms.base import RoomModel
from blender_scenes.scene.description import LightPanel, Sky
from configs.schema.appearance.asset import Asset
from configs.schema.appearance.look import LookConfig
from sensors.camera.colour import LUMINANCE, light_rgb
from symolo.core.arrays import triple

_BRIGHTEST = 2.0
"""Maximum luminance of the sky as a multiple of its mean; the overcast sky of CIE S 011 has 9/7 at its zenith.

Panoramas have up to eleven times the mean, in sunlit clouds and house fronts, whose mirror image in glass burns out."""


def daylight(look: LookConfig, room: RoomModel) -> Lights:
    """Return the panorama scaled to the look's mean luminance, and a panel of its mean colour in the window.

    With a sheer curtain the panel is the curtain: it is visible and transmits the sun's light as well.
    """
    config = look.sky
    mean = np.array(mean_color(config.panorama))
    grey = float(mean @ LUMINANCE)
    gain = config.luminance_kcd_m2 / grey
    named = (
        (config.panorama.sha256, config.panorama.mean_rgb)
        if isinstance(config.panorama, Asset)
        else (config.panorama, None)
    )
    skies = (Sky(named[0], math.radians(config.yaw_deg), gain, _BRIGHTEST * grey, config.saturation, named[1]),)
    sheer = look.window.covering == "sheer"
    # Outside the window, half is sky, and half are houses and ground of about a third of its luminance.
    radiance = 0.65 * (gain * (grey + config.saturation * (mean - grey)))
    if sheer:
        radiance = look.window.curtain_transmittance * (radiance + _sun_on_the_window(look, room) / math.pi)
    if not radiance.any():
        return Lights(skies=skies)
    window = room.window
    behind = room.wall_depth_m if not sheer else CURTAIN_M
    panel = LightPanel(
        "window",
        tuple(np.subtract(window.center, np.multiply(window.inward, behind)).tolist()),
        window.right,
        window.up,
        window.width_m,
        window.height_m,
        triple(radiance),
        seen=sheer,
    )
    meshes, surfaces = curtain(window) if sheer else ((), ())
    return Lights(panels=(panel,), skies=skies, meshes=meshes, surfaces=surfaces)


def _sun_on_the_window(look: LookConfig, room: RoomModel) -> np.ndarray:
    """Return the sun's illuminance [klx] on the plane of the window."""
    facing = -float(np.dot(towards_sun(look, room), room.window.inward))
    return np.multiply(light_rgb(look.sun.color_temperature_K), look.sun.illuminance_klx * max(0.0, facing))
