"""Kinds of light, one file each: functions from the look and the room to the lights of the scene."""

from collections.abc import Callable

from blender_scenes.lighting.base import Lights
from blender_scenes.lighting.ceiling_lamps import ceiling_lamps
from blender_scenes.lighting.daylight import daylight
from blender_scenes.lighting.desk_lamps import desk_lamps
from blender_scenes.lighting.sun import sun
from blender_scenes.lighting.window_covering import blinds
from blender_scenes.rooms.base import RoomModel
from configs.schema.appearance.look import LookConfig

LIGHTS: dict[str, Callable[[LookConfig, RoomModel], Lights]] = {
    "daylight": daylight,
    "sun": sun,
    "blinds": blinds,
    "ceiling_lamps": ceiling_lamps,
    "desk_lamps": desk_lamps,
}
