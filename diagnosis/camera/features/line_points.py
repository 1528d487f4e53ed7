"""Where an edge of the line should be seen in each image."""

from dataclasses import dataclass

import numpy as np

from diagnosis.camera.case import CameraCase, Ints, Mask
from diagnosis.camera.views import CameraView, EdgePoints
from symolo.arena.geometry import Arena, Box
from symolo.core.arrays import Array

ALONG_M = 0.004
"""Between points that are tried."""
MAX_DISTANCE_M = 1.5
SPACING = 1 / 40
"""Of an image's width: between points that are kept, so that each tells something of its own."""
MIN_WIDTH_PX = 4.0
"""A line that seems narrower has no two edges."""
CLEAR_M = (0.001, 0.004, 0.008)
"""So far beyond the edge there must be floor, and no other piece of the line."""
WALL_CLEAR_M = 0.015
"""What is nearer to the foot of a wall has its shadow for an edge."""
RAY_POINTS = 24


@dataclass(frozen=True)
class ExpectedEdges:
    """Edge points with where they should be seen."""

    points: EdgePoints
    pixels: Array
    """(N, 2)."""
    outwards: Array
    """(N, 2), unit vector across the edge in the image, from the line to the floor."""
    width_px: Array
    """(N,), how wide the line seems there."""


def edge_candidates(arena: Arena) -> tuple[Array, Array, Ints]:
    """Middles (M, 2) and outward unit vectors (M, 2) in W of edge points all along the line, and their chain (M,)."""
    middles, outwards, chains = [], [], []
    for number, piece in enumerate(arena.line.pieces):
        s = np.linspace(0.0, piece.length_m, max(2, int(piece.length_m / ALONG_M) + 1))[1:-1]
        middle = piece.at(s)
        for side in (0, 1):
            middles.append(middle)
            outwards.append(piece.at(s, 1.0 - 2.0 * side) - middle)
            chains.append(np.full(len(s), 2 * number + side))
    if not middles:
        return np.empty((0, 2)), np.empty((0, 2)), np.empty(0, np.int64)
    middle, outward, chain = np.concatenate(middles), np.concatenate(outwards), np.concatenate(chains)
    half = 0.5 * arena.line.width_m
    free = np.ones(len(middle), bool)
    for beyond in CLEAR_M:
        free &= ~arena.line.covers(middle + (half + beyond) * outward)
    for box in arena.boxes:
        if box.motion is None:
            free &= ~_covers(box, middle + half * outward, np.zeros(len(middle)), WALL_CLEAR_M)
    return middle[free], outward[free], chain[free]


def expected_edges(view: CameraView, candidates: tuple[Array, Array, Ints], margin_px: float) -> ExpectedEdges:
    """The points of all images that lie at least `margin_px` within them, thinned out."""
    case = view.case
    found = [_in_frame(view, k, candidates, margin_px) for k in range(len(case.frames))]
    parts = [part for part in found if len(part.points)]
    if not parts:
        nothing = EdgePoints(np.empty(0, np.int64), np.empty((0, 2)), np.empty((0, 2)))
        return ExpectedEdges(nothing, np.empty((0, 2)), np.empty((0, 2)), np.empty(0))
    points = EdgePoints(
        np.concatenate([part.points.frame for part in parts]),
        np.concatenate([part.points.on_line for part in parts]),
        np.concatenate([part.points.outwards for part in parts]),
    )
    return ExpectedEdges(
        points,
        np.concatenate([part.pixels for part in parts]),
        np.concatenate([part.outwards for part in parts]),
        np.concatenate([part.width_px for part in parts]),
    )


def _in_frame(view: CameraView, frame: int, candidates: tuple[Array, Array, Ints], margin_px: float) -> ExpectedEdges:
    case = view.case
    X_WC = view.floor_X_WC(frame)
    middle, outward, chain = candidates
    to = middle - X_WC[:2, 3]
    near = (to @ X_WC[:2, 2] > 0) & (np.hypot(*to.T) < MAX_DISTANCE_M)
    middle, outward, chain = middle[near], outward[near], chain[near]
    points = EdgePoints(np.full(len(middle), frame), middle, outward)
    edge = view.pixels(points)
    width, height = case.size_px
    inside = (
        (edge > margin_px).all(axis=1) & (edge[:, 0] < width - 1 - margin_px) & (edge[:, 1] < height - 1 - margin_px)
    )
    inside &= np.isfinite(edge).all(axis=1)
    points, chain, edge = _some(points, inside), chain[inside], edge[inside]
    across, width_px = _across(view, points, edge)
    good = (width_px >= MIN_WIDTH_PX) & ~_hidden(case, frame, X_WC[:3, 3], points)
    kept = np.flatnonzero(good)[_thinned(edge[good], chain[good], SPACING * width)]
    return ExpectedEdges(_some(points, kept), edge[kept], across[kept], width_px[kept])


def _some(points: EdgePoints, which: Mask | Ints) -> EdgePoints:
    return EdgePoints(points.frame[which], points.on_line[which], points.outwards[which])


def _across(view: CameraView, points: EdgePoints, edge: Array) -> tuple[Array, Array]:
    """Unit vectors (N, 2) across the edge in the image, outwards, and the line's width (N,) along them [px]."""
    along = np.column_stack([-points.outwards[:, 1], points.outwards[:, 0]])
    step = EdgePoints(points.frame, points.on_line + 0.001 * along, points.outwards)
    tangent = view.pixels(step) - edge
    other_side = view.pixels(EdgePoints(points.frame, points.on_line, -points.outwards))
    normal = np.column_stack([-tangent[:, 1], tangent[:, 0]])
    normal /= np.maximum(np.hypot(*normal.T), 1e-12)[:, None]
    width = ((edge - other_side) * normal).sum(axis=1)
    sign = np.where(width < 0, -1.0, 1.0)
    return normal * sign[:, None], np.nan_to_num(np.abs(width))


def _thinned(edge: Array, chain: Ints, spacing_px: float) -> Ints:
    """Numbers of points so far apart along their chain."""
    kept, last, last_chain = [], np.zeros(2), -1
    for k in range(len(edge)):
        if chain[k] != last_chain or np.hypot(*(edge[k] - last)) >= spacing_px:
            kept.append(k)
            last, last_chain = edge[k], chain[k]
    return np.array(kept, np.int64)


def _hidden(case: CameraCase, frame: int, eye: Array, points: EdgePoints) -> Mask:
    """Whether a wall or an obstacle stands before a point."""
    floor = points.on_line + 0.5 * case.arena.line.width_m * points.outwards
    hidden = np.zeros(len(floor), bool)
    t_s = np.array([max(case.frames[frame].t_s, 0.0)])
    for box in case.arena.boxes:
        x, y, yaw = box.poses_at(t_s)[0].tolist()
        for share in np.linspace(0.0, 0.96, RAY_POINTS).tolist():
            at = floor + share * (eye[:2] - floor)
            hidden |= _covers(box, at, np.full(len(at), share * eye[2]), 0.004, (x, y, yaw))
    return hidden


def _covers(box: Box, at: Array, z: Array, wider_m: float, pose: tuple[float, float, float] | None = None) -> Mask:
    """Whether points (N, 2) at heights (N,) lie within a box."""
    x, y, yaw = pose or (*box.center[:2], box.yaw_rad)
    dx, dy = at[:, 0] - x, at[:, 1] - y
    c, s = np.cos(yaw), np.sin(yaw)
    along, across = c * dx + s * dy, c * dy - s * dx
    inside = (np.abs(along) <= 0.5 * box.size[0] + wider_m) & (np.abs(across) <= 0.5 * box.size[1] + wider_m)
    return inside & (z <= box.size[2] + wider_m)
