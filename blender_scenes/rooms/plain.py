"""A rectangular room with painted walls, skirting, ceiling and one window with bars."""

from collections.abc import Iterator

import numpy as np

from blender_scenes.description import Mesh, Point2
from blender_scenes.geometry import box, rectangle
from blender_scenes.materials.fittings import painted
from blender_scenes.rooms.base import Opening, Room
from configs.checks import LINTEL_M
from configs.schema.look import LookConfig, Paint, RoomLook

WALL_DEPTH_M = 0.25
_SIDES = {"east": 0.0, "north": 90.0, "west": 180.0, "south": 270.0}
"""Direction of each side's outward normal [deg]."""


def plain_room(look: LookConfig, arena_low: Point2, arena_high: Point2) -> Room:
    """The room whose walls keep the look's margins from the arena's bounds."""
    own = look.room
    low = arena_low[0] - own.margin_west_m, arena_low[1] - own.margin_south_m
    high = arena_high[0] + own.margin_east_m, arena_high[1] + own.margin_north_m
    window = _opening(look, low, high)
    meshes = [_ceiling(low, high, own.height_m)]
    for side in _SIDES:
        meshes += _wall(side, low, high, own, window if side == look.window.side else None)
    meshes += _bars(window, look.window.panes)
    surfaces = (
        painted("room_wall", own.wall, 0.7),
        painted("room_ceiling", Paint(reflectance=0.8), 0.8),
        painted("room_skirting", own.skirting, 0.4),
        painted("window_frame", Paint(reflectance=0.75), 0.35),
    )
    return Room(low, high, own.height_m, WALL_DEPTH_M, window, tuple(meshes), surfaces)


def _frame(side: str, low: Point2, high: Point2) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Middle of the wall's foot, unit vector to the right as seen from inside, outward normal, and length."""
    angle = np.radians(_SIDES[side])
    outward = np.round(np.array([np.cos(angle), np.sin(angle), 0.0]))
    right = np.array([outward[1], -outward[0], 0.0])
    half = 0.5 * np.subtract(high, low)
    middle = 0.5 * np.add(low, high)
    foot = np.array([*middle, 0.0]) + outward * abs(float(outward[:2] @ half))
    return foot, right, outward, 2 * abs(float(right[:2] @ half))


def _opening(look: LookConfig, low: Point2, high: Point2) -> Opening:
    foot, right, outward, length = _frame(look.window.side, low, high)
    width = min(look.window.width_m, length - 0.2)
    height = min(look.window.height_m, look.room.height_m - look.window.sill_m - LINTEL_M)
    center = foot + np.array([0, 0, look.window.sill_m + 0.5 * height])
    return Opening(
        center=tuple(center.tolist()),
        right=tuple(right.tolist()),
        up=(0.0, 0.0, 1.0),
        inward=tuple((-outward).tolist()),
        width_m=width,
        height_m=height,
    )


def _ceiling(low: Point2, high: Point2, height: float) -> Mesh:
    (x0, y0), (x1, y1) = low, high
    corners = ((x0, y1, height), (x1, y1, height), (x1, y0, height), (x0, y0, height))
    return rectangle("ceiling", corners, "room_ceiling")


def _wall(side: str, low: Point2, high: Point2, own: RoomLook, window: Opening | None) -> Iterator[Mesh]:
    """Slabs of the wall around the window, and its skirting."""
    foot, right, outward, length = _frame(side, low, high)

    def slab(name: str, along: Point2, upward: Point2, outwards: Point2, surface: str) -> Mesh:
        """A block between two places each along the wall, upward, and along the outward normal."""
        (a, b), (inner, outer) = along, outwards
        lower = np.array([foot + right * s + outward * d for s, d in ((a, inner), (b, inner), (b, outer), (a, outer))])
        corners = np.concatenate([np.add(lower, (0.0, 0.0, height)) for height in upward])
        return box(f"{side}_{name}", corners, (surface,) * 6)

    half, deep = 0.5 * length + WALL_DEPTH_M, (0.0, WALL_DEPTH_M)
    yield slab("skirting", (-half, half), (0.0, own.skirting_height_m), (-0.012, 0.0), "room_skirting")
    if window is None:
        yield slab("wall", (-half, half), (0.0, own.height_m), deep, "room_wall")
        return
    edge, sill = 0.5 * window.width_m, window.center[2] - 0.5 * window.height_m
    lintel = sill + window.height_m
    yield slab("wall_left", (-half, -edge), (0.0, own.height_m), deep, "room_wall")
    yield slab("wall_right", (edge, half), (0.0, own.height_m), deep, "room_wall")
    yield slab("wall_below", (-edge, edge), (0.0, sill), deep, "room_wall")
    yield slab("wall_above", (-edge, edge), (lintel, own.height_m), deep, "room_wall")


def _bars(window: Opening, panes: int) -> Iterator[Mesh]:
    """Frame and bars, 60 mm wide, in the middle of the wall's depth."""
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
