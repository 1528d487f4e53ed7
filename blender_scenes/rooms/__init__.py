"""Rooms around the arena, one file each."""

from blender_scenes.rooms.plain import plain_room

ROOMS = {"plain": plain_room}
