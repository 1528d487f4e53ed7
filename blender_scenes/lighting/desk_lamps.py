"""Lamps on the tables: a bulb in a hood, turned towards the middle of the room."""

import math
from dataclasses import replace

import numpy as np

from blender_scenes.lighting.base import Lights
from blender_scenes.lighting.ceiling_lamps import hood
from blender_scenes.materials.fittings import moulded
from blender_scenes.rooms.base import RoomModel, Top
from blender_scenes.scene.description import LightPanel, Mesh
from blender_scenes.scene.solids import joined, lathe, moved, posed, rod
from configs.schema.appearance.lighting import DeskLampsLook
from configs.schema.appearance.look import LookConfig
from sensors.camera.colour import light_rgb, scaled
from symolo.core.arrays import Array, triple

_BULB_M = 0.07
_NECK_M, _RIM_M, _HOOD_M = 0.052, 0.085, 0.11
_BULB_DEPTH_M = 0.06
"""Distance of the bulb behind the plane of the rim."""
_FROM_EDGE_M = 0.12
_REACH_M = 0.14
_AT_THE_MIDDLE_M = 1e-6
"""Distance from the room's middle below which the direction towards it is undefined."""


def desk_lamps(look: LookConfig, room: RoomModel) -> Lights:
    """Return a lamp on each of the first tables, at the place of the top that is nearest to the room's middle.

    The bulb is a Lambertian square of luminance flux / (pi area), deep in the hood, which blocks its light sideways.
    A lamp that is off has only its body.
    """
    config = look.desk_lamps
    radiance = scaled(light_rgb(config.color_temperature_K), config.flux_klm / (math.pi * _BULB_M**2))
    middle = 0.5 * np.add(room.low, room.high)
    panels, meshes = [], []
    for number, top in enumerate(room.tops[: config.count]):
        foot, towards = _stand(top, middle)
        head, axes = _head(foot, towards, config)
        right, up, axis = (triple(axes[:, i]) for i in range(3))
        bulb = head - _BULB_DEPTH_M * np.array(axis)
        name = f"desk_lamp_{number}"
        if config.flux_klm > 0:
            panels.append(LightPanel(name, triple(bulb), right, up, _BULB_M, _BULB_M, radiance))
        meshes.append(_body(name, foot, head, axes))
    hood_surface = replace(moulded("desk_lamp_hood", (0.5, 0.5, 0.48), 0.4), encloses_lamp=True)
    surfaces = moulded("desk_lamp_enamel", (0.05, 0.05, 0.055), 0.35), hood_surface
    return Lights(panels=tuple(panels), meshes=tuple(meshes), surfaces=surfaces if meshes else ())


def _stand(top: Top, middle: Array) -> tuple[Array, Array]:
    """Return the foot of the lamp and the horizontal direction to the room's middle; along the table if it is there."""
    x, y, yaw = top.pose
    R_WT = np.array([[math.cos(yaw), -math.sin(yaw)], [math.sin(yaw), math.cos(yaw)]])
    half = np.maximum(0.5 * np.array(top.size_m) - _FROM_EDGE_M, 0.0)
    nearest = R_WT @ np.clip(R_WT.T @ (middle - (x, y)), -half, half) + (x, y)
    away = middle - nearest
    if np.linalg.norm(away) < _AT_THE_MIDDLE_M:
        away = R_WT[:, 0]
    return np.array([*nearest, top.height_m]), np.array([*(away / np.linalg.norm(away)), 0.0])


def _head(foot: Array, towards: Array, config: DeskLampsLook) -> tuple[Array, Array]:
    """Return the middle of the hood's rim, and its axes as columns: right, up and the direction of the light."""
    tilt = math.radians(config.tilt_deg)
    axis = math.sin(tilt) * towards - math.cos(tilt) * np.array([0.0, 0.0, 1.0])
    right = np.cross(towards, (0.0, 0.0, 1.0))
    head = foot + _REACH_M * towards + np.array([0.0, 0.0, config.height_m])
    return head, np.stack([right, np.cross(axis, right), axis], axis=1)


def _body(name: str, foot: Array, head: Array, axes: Array) -> Mesh:
    base = moved(lathe("base", [(0.075, 0.0), (0.075, 0.012), (0.02, 0.02)], "desk_lamp_enamel"), triple(foot))
    neck = head - _HOOD_M * axes[:, 2]
    arm = rod("arm", (triple(foot + np.array([0.0, 0.0, 0.015])), triple(neck)), (0.008, 0.006), "desk_lamp_enamel")
    # The hood opens along -z of its own frame.
    shade = posed(hood(_NECK_M, _RIM_M, _HOOD_M, "desk_lamp_hood"), axes @ np.diag([1.0, -1.0, -1.0]), triple(head))
    return joined(name, [base, arm, shade])
