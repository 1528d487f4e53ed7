"""The scene of a run: arena, room, light and robot put together from configuration and seed."""

import math
from dataclasses import replace

import numpy as np

from blender_scenes import geometry
from blender_scenes.description import Mesh, Point2, Scene
from blender_scenes.lighting import LIGHTS
from blender_scenes.materials import FLOORS, SURFACES
from blender_scenes.materials.base import Patch
from blender_scenes.materials.dirt import dirtied
from blender_scenes.materials.tape import tape
from blender_scenes.robot_body import robot_body, robot_surfaces
from blender_scenes.rooms import ROOMS
from blender_scenes.rooms.base import Room
from blender_scenes.shading import Surface
from configs.schema.look import LookConfig
from configs.schema.robot import RobotConfig
from physics.arena import Arena, Box
from physics.obstacle_motion import ObstacleMotion


def describe(arena: Arena, robot: RobotConfig, look: LookConfig, seed: int) -> Scene:
    """The scene that the run's camera sees; the same arguments give the same scene."""
    low, high = arena_bounds(arena)
    room = ROOMS["plain"](look, low, high, seed)
    parts = [_floor(look, room, seed), *_line(arena, look, seed)]
    parts += [_box(box, look, seed) for box in arena.boxes if box.motion is None]
    moving = [_box(_in_its_frame(box), look, seed) for box in arena.moving]
    lights = [light(look, room) for light in LIGHTS.values()]
    surfaces = [s for _, own in parts + moving for s in own] + list(room.surfaces) + list(robot_surfaces())
    surfaces += [surface for light in lights for surface in light.surfaces]
    suns = [sun for light in lights for sun in light.suns]
    (sky,) = [sky for light in lights for sky in light.skies]
    return Scene(
        surfaces=tuple(surfaces),
        meshes=(*(mesh for mesh, _ in parts), *room.meshes, *(mesh for light in lights for mesh in light.meshes)),
        robot=robot_body(robot),
        panels=tuple(panel for light in lights for panel in light.panels),
        sun=suns[0] if suns else None,
        sky=sky,
        moving=tuple(mesh for mesh, _ in moving),
    )


def arena_bounds(arena: Arena) -> tuple[Point2, Point2]:
    """Corners of the rectangle that holds line and boxes, on all of their way; a square metre for an empty arena."""
    points = [np.concatenate(edges) for edges in arena.line.edges()]
    points += [box.footprint() if box.motion is None else _reach(box, box.motion) for box in arena.boxes]
    everything = np.concatenate(points) if points else np.array([[-0.5, -0.5], [0.5, 0.5]])
    low, high = everything.min(axis=0), everything.max(axis=0)
    return (float(low[0]), float(low[1])), (float(high[0]), float(high[1]))


def _reach(box: Box, motion: ObstacleMotion) -> np.ndarray:
    """Points (N, 2) whose bounds hold a box on all of its way, however it is turned."""
    places, half = np.array(motion.poses)[:, :2], 0.5 * math.hypot(*box.size[:2])
    return np.concatenate([places - half, places + half])


Part = tuple[Mesh, tuple[Surface, ...]]


def _floor(look: LookConfig, room: Room, seed: int) -> Part:
    size = room.high[0] - room.low[0], room.high[1] - room.low[1]
    patch = Patch("floor", size, seed)
    surface = dirtied(FLOORS[look.floor.material](look.floor, patch), patch, look.floor.dirt)
    mesh = geometry.floor("floor", room.low, room.high, math.radians(look.floor.yaw_deg), surface.name)
    return mesh, (surface,)


def _line(arena: Arena, look: LookConfig, seed: int) -> list[Part]:
    pieces = arena.line.pieces
    surfaces = [
        tape(look.tape, Patch(f"tape_{i}", (piece.length_m, arena.line.width_m), seed))
        for i, piece in enumerate(pieces)
    ]
    meshes = geometry.tapes(arena.line, look.tape.thickness_m, [surface.name for surface in surfaces])
    return [(mesh, (surface,)) for mesh, surface in zip(meshes, surfaces, strict=True)]


def _box(box: Box, look: LookConfig, seed: int) -> Part:
    name = f"{box.kind}_{box.name}"
    make, (length, width, height) = SURFACES[box.surface], box.size
    ends = make(look, Patch(f"{name}_ends", (width, height), seed))
    sides = make(look, Patch(f"{name}_sides", (length, height), seed))
    lid = make(look, Patch(f"{name}_lid", (length, width), seed))
    # No face lies on the floor: where two coincide, glass would turn black.
    faces = {"back": ends, "right": sides, "front": ends, "left": sides, "bottom": None, "top": lid}
    names = [face and face.name for face in (faces[side] for side in geometry.SIDES)]
    return geometry.box(name, geometry.box_corners(box), names), (ends, sides, lid)


def _in_its_frame(box: Box) -> Box:
    return replace(box, center=(0.0, 0.0, box.center[2]), yaw_rad=0.0)
