"""Points on the edges of the line, and the pixels at which a camera sees them."""

from dataclasses import dataclass, replace

import numpy as np

from diagnosis.camera.case import CameraCase, Ints
from diagnosis.camera.views import CameraView, EdgePoints
from diagnosis.measured.channel import Mask
from symolo.arena.geometry import Arena, Box
from symolo.core.arrays import Array

ALONG_M = 0.004
"""Distance between the points that are tried."""
MAX_DISTANCE_M = 1.5
"""Largest distance of a point from the camera."""
SPACING = 1 / 40
"""Distance between points that are used, as a share of the image's width; closer ones contain the same texture."""
MIN_WIDTH_PX = 4.0
"""Smallest width of a line in the image at which its two edges can be distinguished."""
CLEAR_M = (0.001, 0.004, 0.008)
"""Distances beyond the edge at which there must be floor, and no other piece of the line."""
WALL_CLEAR_M = 0.015
"""Distance from the foot of a wall within which its shadow may be mistaken for an edge."""
RAY_POINTS = 24
"""Points of a ray from the floor to the camera that are checked for obstacles."""


@dataclass(frozen=True)
class LineEdges(EdgePoints):
    """Edge points with the pixels at which they are expected, or were measured."""

    pixels: Array
    """(N, 2), column and row in the image."""
    outwards: Array
    """(N, 2), unit vector across the edge in the image, from the line to the floor."""
    width_px: Array
    """(N,), width of the line in the image at each point."""


def edge_candidates(arena: Arena) -> tuple[Array, Array, Ints]:
    """Return edge points all along the line.

    Returns:
        Points on the middle of the line (M, 2), unit vectors over the edge (M, 2), both in W, and the number of the
        edge to which each point belongs, (M,).
    """
    middles, outwards, chains = [], [], []
    for number, piece in enumerate(arena.line.pieces):
        s = np.linspace(0.0, piece.length_m, max(2, int(piece.length_m / ALONG_M) + 1))[1:-1]
        middle = piece.at(s)
        for edge in (0, 1):
            middles.append(middle)
            outwards.append(piece.at(s, 1.0 - 2.0 * edge) - middle)
            chains.append(np.full(len(s), 2 * number + edge))
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


def expected_edges(view: CameraView, candidates: tuple[Array, Array, Ints], margin_px: float) -> LineEdges:
    """Return the points of all images that lie at least `margin_px` within them, thinned out."""
    return LineEdges.joined([_in_frame(view, k, candidates, margin_px) for k in range(len(view.case.frames))])


def _in_frame(view: CameraView, frame: int, candidates: tuple[Array, Array, Ints], margin_px: float) -> LineEdges:
    case = view.case
    X_WC = view.floor_X_WC(frame)
    middle, outward, chain = candidates
    to_point = middle - X_WC[:2, 3]
    near = (to_point @ X_WC[:2, 2] > 0) & (np.hypot(*to_point.T) < MAX_DISTANCE_M)
    points = EdgePoints(np.full(np.count_nonzero(near), frame), middle[near], outward[near])
    pixels, chain = view.pixels(points), chain[near]
    size = np.array(case.size_px)
    inside = np.isfinite(pixels).all(axis=1) & ((pixels > margin_px) & (pixels < size - 1 - margin_px)).all(axis=1)
    points, pixels, chain = points.some(inside), pixels[inside], chain[inside]
    across, width_px = _across(view, points, pixels)
    edges = LineEdges(points.frame, points.on_line, points.outwards_W, pixels, across, width_px)
    good = (width_px >= MIN_WIDTH_PX) & ~_hidden(case, frame, X_WC[:3, 3], points)
    edges = edges.some(good)
    return edges.some(_thinned(edges.pixels, chain[good], SPACING * case.size_px[0]))


def _across(view: CameraView, points: EdgePoints, edge: Array) -> tuple[Array, Array]:
    """Return unit vectors (N, 2) across the edge in the image, outwards, and the line's width (N,) along them [px]."""
    along = np.column_stack([-points.outwards_W[:, 1], points.outwards_W[:, 0]])
    tangent = view.pixels(replace(points, on_line=points.on_line + 0.001 * along)) - edge
    other_edge = view.pixels(replace(points, outwards_W=-points.outwards_W))
    normal = np.column_stack([-tangent[:, 1], tangent[:, 0]])
    normal /= np.maximum(np.hypot(*normal.T), 1e-12)[:, None]
    width = ((edge - other_edge) * normal).sum(axis=1)
    sign = np.where(width < 0, -1.0, 1.0)
    return normal * sign[:, None], np.nan_to_num(np.abs(width))


def _thinned(edge: Array, chain: Ints, spacing_px: float) -> Ints:
    """Return the indices of points that are at least `spacing_px` apart along their edge."""
    indices, last, last_chain = [], np.zeros(2), -1
    for k in range(len(edge)):
        if chain[k] != last_chain or np.hypot(*(edge[k] - last)) >= spacing_px:
            indices.append(k)
            last, last_chain = edge[k], chain[k]
    return np.array(indices, np.int64)


def _hidden(case: CameraCase, frame: int, eye: Array, points: EdgePoints) -> Mask:
    """Return whether a wall or an obstacle hides each point, (N,)."""
    floor = points.on_line + 0.5 * case.arena.line.width_m * points.outwards_W
    hidden = np.zeros(len(floor), bool)
    t_s = np.array([max(case.frames[frame].t_s, 0.0)])
    for box in case.arena.boxes:
        x, y, yaw = box.poses_at(t_s)[0].tolist()
        for share in np.linspace(0.0, 0.96, RAY_POINTS).tolist():
            at = floor + share * (eye[:2] - floor)
            hidden |= _covers(box, at, np.full(len(at), share * eye[2]), 0.004, (x, y, yaw))
    return hidden


def _covers(box: Box, at: Array, z: Array, wider_m: float, pose: tuple[float, float, float] | None = None) -> Mask:
    """Return whether points (N, 2) at heights (N,) lie within a box, (N,)."""
    x, y, yaw = pose or (*box.center[:2], box.yaw_rad)
    dx, dy = at[:, 0] - x, at[:, 1] - y
    c, s = np.cos(yaw), np.sin(yaw)
    along, across = c * dx + s * dy, c * dy - s * dx
    inside = (np.abs(along) <= 0.5 * box.size[0] + wider_m) & (np.abs(across) <= 0.5 * box.size[1] + wider_m)
    return inside & (z <= box.size[2] + wider_m)
