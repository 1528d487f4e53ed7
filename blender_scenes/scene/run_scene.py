"""The scene of a run: arena, room, light and robot from configuration and seed."""

import math
from dataclasses import replace

import numpy as np

from blender_scenes.lighting import LIGHTS
from blender_scenes.materials import FLOORS, body_material
from blender_scenes.materials.base import SurfacePatch
from blender_scenes.materials.line.line_paint import line_paint
from blender_scenes.materials.line.tape import tape
from blender_scenes.materials.marks.dirt import dirtied
from blender_scenes.materials.marks.stains import stained
from blender_scenes.materials.paper import paper
from blender_scenes.rooms.base import RoomModel
from blender_scenes.rooms.plain import plain_room, room_bounds
from blender_scenes.scene import line_mesh
from blender_scenes.scene import meshes as geometry
from blender_scenes.scene.bevel import BEVEL_M, bevelled_box
from blender_scenes.scene.description import Mesh, Point2, Scene
from blender_scenes.scene.line_sheets import with_sheets
from blender_scenes.scene.robot_body import CAMERA_BODY, robot_body, robot_surfaces
from blender_scenes.scene.shading import Surface
from configs.schema.appearance.look import LinePaintLook, LookConfig, PaintedLook, TapeLook
from configs.schema.robot import RobotConfig
from symolo.arena.geometry import Arena, Box, Line
from symolo.arena.obstacle_motion import ObstacleMotion

_GLASS_BEVEL_M = 0.0001
"""Bevel of polished glass; a wider one would be black, because light is reflected inside it again and again."""


def describe(arena: Arena, robot: RobotConfig, look: LookConfig, seed: int) -> Scene:
    """Return the scene of a run; the same arguments give the same scene."""
    room = room_around(arena, look, seed)
    parts = [_floor(arena.line, look, room, seed), *_line(arena, look, seed)]
    parts += [_box(box, look, seed) for box in arena.boxes if box.motion is None]
    in_own_frames = [replace(box, center=(0.0, 0.0, box.center[2]), yaw_rad=0.0) for box in arena.moving]
    moving = [_box(box, look, seed) for box in in_own_frames]
    lights = [light(look, room) for light in LIGHTS.values()]
    surfaces = (
        [s for _, mesh_surfaces in parts + moving for s in mesh_surfaces]
        + list(room.surfaces)
        + list(robot_surfaces(robot))
    )
    surfaces += [surface for light in lights for surface in light.surfaces]
    suns = [sun for light in lights for sun in light.suns]
    (sky,) = [sky for light in lights for sky in light.skies]
    body = robot_body(robot)
    in_sight = tuple(part for part in body if robot.camera.sees_robot and part.name != CAMERA_BODY)
    return Scene(
        surfaces=tuple(surfaces),
        meshes=(*(mesh for mesh, _ in parts), *room.meshes, *(mesh for light in lights for mesh in light.meshes)),
        robot=tuple(part for part in body if part not in in_sight),
        panels=tuple(panel for light in lights for panel in light.panels),
        sun=suns[0] if suns else None,
        sky=sky,
        moving=tuple(mesh for mesh, _ in moving),
        robot_in_sight=in_sight,
    )


def room_around(arena: Arena, look: LookConfig, seed: int) -> RoomModel:
    """Return the room of the scene with its furniture."""
    low, high = arena_bounds(arena)
    return plain_room(look, low, high, seed)


def arena_bounds(arena: Arena) -> tuple[Point2, Point2]:
    """Return the corners of the rectangle around line and boxes, wherever these move; without any, of the floor."""
    points = [np.concatenate(edges) for edges in arena.line.edges()]
    points += [box.footprint() if box.motion is None else _reach(box, box.motion) for box in arena.boxes]
    half_m = arena.floor_half_extent_m
    everything = np.concatenate(points) if points else np.array([[-half_m, -half_m], [half_m, half_m]])
    low, high = everything.min(axis=0), everything.max(axis=0)
    return (float(low[0]), float(low[1])), (float(high[0]), float(high[1]))


def floor_bounds(arena: Arena, look: LookConfig) -> tuple[Point2, Point2]:
    """Return the corners of the floor, which ends at the walls of the room."""
    return room_bounds(look.room, *arena_bounds(arena))


def _reach(box: Box, motion: ObstacleMotion) -> np.ndarray:
    """Return points (N, 2) whose bounds contain a moving box everywhere, at any yaw."""
    places, half = np.array(motion.poses)[:, :2], 0.5 * math.hypot(*box.size[:2])
    return np.concatenate([places - half, places + half])


MeshAndSurfaces = tuple[Mesh, tuple[Surface, ...]]


def _floor(line: Line, look: LookConfig, room: RoomModel, seed: int) -> MeshAndSurfaces:
    size = room.high[0] - room.low[0], room.high[1] - room.low[1]
    patch = SurfacePatch("floor", size, seed)
    surface = stained(FLOORS[look.floor.material](look.floor, patch), patch, look.floor.stains)
    surface = dirtied(surface, patch, look.floor.dirt)
    mesh = geometry.floor("floor", room.low, room.high, math.radians(look.floor.yaw_deg), surface.name)
    sheets = look.line_sheets
    if sheets.width_m == 0:
        return mesh, (surface,)
    paper_of_sheets = PaintedLook(paint=sheets.paint, roughness=sheets.roughness)
    patch = SurfacePatch("line_sheets", (sheets.length_m, sheets.width_m), seed)
    sheet = paper(look.model_copy(update={"paper": paper_of_sheets}), patch)
    # The sheets are younger than the floor.
    sheet = dirtied(stained(sheet, patch, 0.5 * look.floor.stains), patch, 0.5 * look.floor.dirt)
    return with_sheets(mesh, line, sheets, sheet.name, seed), (surface, sheet)


def _line(arena: Arena, look: LookConfig, seed: int) -> list[MeshAndSurfaces]:
    if look.line == "paint":
        return _painted(arena.line, look.line_paint, seed)
    bed_m = look.floor.carpet.loop_m if look.floor.material == "carpet" else 0.0
    return _taped(arena.line, look.tape, bed_m, seed)


def _taped(line: Line, look: TapeLook, bed_m: float, seed: int) -> list[MeshAndSurfaces]:
    surfaces = []
    for i, strip in enumerate(line.strips):
        size = line_mesh.taped_length_m(strip, look.gap_m), line.width_m
        surfaces.append(tape(look, SurfacePatch(f"tape_{i}", size, seed), strip.curvature_per_m, bed_m))
    meshes = line_mesh.tapes(
        line,
        [surface.name for surface in surfaces],
        thickness_m=look.thickness_m,
        gap_m=look.gap_m,
        lift_m=look.lift_m,
        seed=seed,
    )
    return [(mesh, (surface,)) for mesh, surface in zip(meshes, surfaces, strict=True)]


def _painted(line: Line, look: LinePaintLook, seed: int) -> list[MeshAndSurfaces]:
    surface = line_paint(look, SurfacePatch("line_paint", (line.length_m, line.width_m), seed))
    meshes = line_mesh.paint(line, surface.name, thickness_m=look.thickness_m, bleeding_m=look.bleeding_m, seed=seed)
    return [(mesh, (surface,) if number == 0 else ()) for number, mesh in enumerate(meshes)]


def _box(box: Box, look: LookConfig, seed: int) -> MeshAndSurfaces:
    name = f"{box.kind}_{box.name}"
    length, width, height = box.size
    if box.mesh is not None:
        surface = body_material(look, box.surface, SurfacePatch(f"{name}_body", (max(length, width), height), seed))
        return geometry.triangle_body(name, box, box.mesh, surface.name), (surface,)
    ends = body_material(look, box.surface, SurfacePatch(f"{name}_ends", (width, height), seed))
    sides = body_material(look, box.surface, SurfacePatch(f"{name}_sides", (length, height), seed))
    lid = body_material(look, box.surface, SurfacePatch(f"{name}_lid", (length, width), seed))
    # No face lies on the floor: where two coincide, glass would turn black.
    around = (ends.name, sides.name, ends.name, sides.name)
    bevel_m = _GLASS_BEVEL_M if box.surface == "glass" else BEVEL_M
    return bevelled_box(name, geometry.box_corners(box), around, lid.name, bevel_m), (ends, sides, lid)
