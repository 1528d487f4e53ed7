"""A rectangular room with painted walls, skirting, ceiling, one window with bars, and furniture."""

from collections.abc import Iterator

import numpy as np

from blender_scenes.materials.fittings import painted
from blender_scenes.rooms.base import Opening, RoomModel
from blender_scenes.rooms.furnishing import furnished
from blender_scenes.rooms.walls import SIDES, RoomWall, wall
from blender_scenes.scene.description import Mesh, Point2
from blender_scenes.scene.meshes import box, rectangle
from blender_scenes.scene.solids import stood
from configs.checks.look import LINTEL_M
from configs.schema.appearance.look import LookConfig
from configs.schema.appearance.paint import Paint
from configs.schema.appearance.room import RoomLook
from symolo.arena.footprints import Rectangle

WALL_DEPTH_M = 0.25


def plain_room(look: LookConfig, arena_low: Point2, arena_high: Point2, seed: int) -> RoomModel:
    """Return the room whose walls keep the look's margins from the arena's bounds; `seed` draws its furniture."""
    config = look.room
    low, high = room_bounds(config, arena_low, arena_high)
    window = _opening(look, low, high)
    meshes = [_ceiling(low, high, config.height_m)]
    for side in SIDES:
        meshes += _wall(wall(side, low, high), config, window if side == look.window.side else None)
    meshes += _bars(window, look.window.panes)
    size = arena_high[0] - arena_low[0], arena_high[1] - arena_low[1]
    arena = Rectangle((0.5 * (arena_low[0] + arena_high[0]), 0.5 * (arena_low[1] + arena_high[1])), size, 0.0)
    furniture = furnished(look, low, high, window, arena, seed)
    surfaces = (
        painted("room_wall", config.wall, 0.7),
        painted("room_ceiling", Paint(reflectance=0.8), 0.8),
        painted("room_skirting", config.skirting, 0.4),
        painted("window_frame", Paint(reflectance=0.75), 0.35),
    )
    return RoomModel(
        low,
        high,
        config.height_m,
        WALL_DEPTH_M,
        window,
        (*meshes, *(stood(item.piece.mesh, item.pose) for item in furniture)),
        (*surfaces, *(surface for item in furniture for surface in item.piece.surfaces)),
        tuple(top for item in furniture if (top := item.top) is not None),
        tuple(item.furnishing for item in furniture),
    )


def room_bounds(config: RoomLook, arena_low: Point2, arena_high: Point2) -> tuple[Point2, Point2]:
    """Return the south-west and north-east corners of the floor."""
    low = arena_low[0] - config.margin_west_m, arena_low[1] - config.margin_south_m
    return low, (arena_high[0] + config.margin_east_m, arena_high[1] + config.margin_north_m)


def _opening(look: LookConfig, low: Point2, high: Point2) -> Opening:
    place = wall(look.window.side, low, high)
    width = min(look.window.width_m, place.length_m - 0.2)
    height = min(look.window.height_m, look.room.height_m - look.window.sill_m - LINTEL_M)
    center = place.foot + np.array([0, 0, look.window.sill_m + 0.5 * height])
    return Opening(
        center=tuple(center.tolist()),
        right=tuple(place.right.tolist()),
        up=(0.0, 0.0, 1.0),
        inward=tuple((-place.outward).tolist()),
        width_m=width,
        height_m=height,
    )


def _ceiling(low: Point2, high: Point2, height: float) -> Mesh:
    (x0, y0), (x1, y1) = low, high
    corners = ((x0, y1, height), (x1, y1, height), (x1, y0, height), (x0, y0, height))
    return rectangle("ceiling", corners, "room_ceiling")


def _wall(place: RoomWall, config: RoomLook, window: Opening | None) -> Iterator[Mesh]:
    """Yield the skirting of a wall and its slabs around the window."""
    foot, right, outward, side = place.foot, place.right, place.outward, place.side

    def slab(name: str, along: Point2, upward: Point2, outwards: Point2, surface: str) -> Mesh:
        """Return a block between two places each along the wall, upward, and along the outward normal."""
        (a, b), (inner, outer) = along, outwards
        lower = np.array([foot + right * s + outward * d for s, d in ((a, inner), (b, inner), (b, outer), (a, outer))])
        corners = np.concatenate([np.add(lower, (0.0, 0.0, height)) for height in upward])
        return box(f"{side}_{name}", corners, (surface,) * 6)

    half, deep = 0.5 * place.length_m + WALL_DEPTH_M, (0.0, WALL_DEPTH_M)
    yield slab("skirting", (-half, half), (0.0, config.skirting_height_m), (-0.012, 0.0), "room_skirting")
    if window is None:
        yield slab("wall", (-half, half), (0.0, config.height_m), deep, "room_wall")
        return
    edge, sill = 0.5 * window.width_m, window.center[2] - 0.5 * window.height_m
    lintel = sill + window.height_m
    yield slab("wall_left", (-half, -edge), (0.0, config.height_m), deep, "room_wall")
    yield slab("wall_right", (edge, half), (0.0, config.height_m), deep, "room_wall")
    yield slab("wall_below", (-edge, edge), (0.0, sill), deep, "room_wall")
    yield slab("wall_above", (-edge, edge), (lintel, config.height_m), deep, "room_wall")


def _bars(window: Opening, panes: int) -> Iterator[Mesh]:
    """Yield frame and bars, 60 mm wide, in the middle of the wall's depth."""
    right, up, inward = np.array(window.right), np.array(window.up), np.array(window.inward)
    half_w, half_h, half = 0.5 * window.width_m, 0.5 * window.height_m, 0.03
    middle = np.array(window.center) - inward * 0.5 * WALL_DEPTH_M

    def bar(name: str, s0: float, s1: float, h0: float, h1: float) -> Mesh:
        lower = [middle + right * s + inward * d for s, d in ((s0, half), (s1, half), (s1, -half), (s0, -half))]
        corners = np.concatenate([np.array(lower) + up * h0, np.array(lower) + up * h1])
        return box(f"window_{name}", corners, ("window_frame",) * 6)

    yield bar("bottom", -half_w, half_w, -half_h, -half_h + 2 * half)
    yield bar("top", -half_w, half_w, half_h - 2 * half, half_h)
    for i in range(panes + 1):
        s = -half_w + half + i * (2 * half_w - 2 * half) / panes
        yield bar(f"bar_{i}", s - half, s + half, -half_h, half_h)
