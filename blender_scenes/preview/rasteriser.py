"""The triangle in the middle of each pixel, its depth and the surface coordinates there.

Homogeneous rasterisation after Olano and Greer, "Triangle Scan Conversion using 2D Homogeneous Coordinates" (1997):
with the corners P0, P1, P2 in C, a ray d = (x, y, 1) meets the triangle in front of the camera where the three
functions (Pj x Pk) . d / det(P0, P1, P2) are positive. They sum to 1/depth and are the corners' weights over depth, so
that a triangle that reaches behind the camera needs no clipping and everything on it is perspective-correct.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from blender_scenes.preview.triangles import Triangles
from symolo.core.arrays import Array
from symolo.core.geometry.pinhole import Intrinsics

NEAR_M = 0.001
"""Depth below which nothing is visible, as for Blender's camera."""

Ints = NDArray[np.intp]


@dataclass(frozen=True)
class VisibleTriangles:
    """What is visible in the middle of each pixel."""

    triangle: Ints
    """(H, W), number of the triangle, -1 where there is none."""
    depth_m: Array
    """(H, W), depth along the optical axis; infinite where there is no triangle."""
    uv_m: Array
    """(H, W, 2), surface coordinates [m]; 0 where there is no triangle."""


@dataclass(frozen=True)
class _Planes:
    """Functions that are linear in the image, as coefficients of column, row and 1."""

    index: Ints
    """(T,), numbers of the triangles that may be visible."""
    edges: Array
    """(T, 3, 3), a function for each side, positive towards the inside of the triangle."""
    weights: Array
    """(T, 3, 3), the same functions, scaled to the opposite corner's weight divided by depth."""
    rows: Ints
    """(T, 2), first and last row that the triangle may touch."""


def rasterise(camera: Intrinsics, X_WC: Array, triangles: Triangles) -> VisibleTriangles:
    """Return what a pinhole camera sees of triangles in W; both of their sides are visible."""
    planes = _planes(camera, X_WC, triangles)
    at, row, first, last = _spans(camera, planes)
    count = last - first + 1
    start = np.cumsum(count) - count
    span = np.repeat(np.arange(len(count)), count)
    column = first[span] + np.arange(len(span)) - start[span]
    inverse = planes.weights.sum(axis=1)  # 1/depth
    left = inverse[at, 1] * row + inverse[at, 2]
    nearness = inverse[at, 0][span] * column + left[span]
    pixel = (row * camera.width_px)[span] + column
    nearest, shown = _nearest(pixel, nearness, at[span], camera.width_px * camera.height_px)
    return _seen(camera, planes, triangles, nearest, shown)


def _planes(camera: Intrinsics, X_WC: Array, triangles: Triangles) -> _Planes:
    corners = (triangles.corners - X_WC[:3, 3]) @ X_WC[:3, :3]
    sides = np.cross(corners[:, [1, 2, 0]], corners[:, [2, 0, 1]])
    determinant = np.einsum("ij,ij->i", sides[:, 0], corners[:, 0])
    rows, ahead = _touched(camera, corners)
    index = np.flatnonzero(ahead & (determinant != 0))
    x, y, one = np.moveaxis(sides[index] * np.sign(determinant[index])[:, None, None], -1, 0)
    x, y = x / camera.fx_px, y / camera.fy_px
    # Two triangles with a common side get the same numbers for it but for the sign, so that there is no gap between.
    edges = np.stack([x, y, one - x * camera.cx_px - y * camera.cy_px], axis=-1)
    return _Planes(index, edges, edges / np.abs(determinant[index])[:, None, None], rows[index])


def _touched(camera: Intrinsics, corners: Array) -> tuple[Ints, NDArray[np.bool_]]:
    """Return the rows (T, 2) that triangles (T, 3, 3) in C may touch, and whether they may touch the image at all."""
    depth = corners[..., 2]
    whole = (depth > NEAR_M).all(axis=1)
    safe = np.where(depth > NEAR_M, depth, 1.0)
    u = camera.fx_px * corners[..., 0] / safe + camera.cx_px
    v = camera.fy_px * corners[..., 1] / safe + camera.cy_px
    last = camera.height_px - 1
    rows = np.stack([np.floor(v.min(axis=1)), np.ceil(v.max(axis=1))], axis=1)
    rows = np.where(whole[:, None], np.clip(rows, -1, last + 1), (0, last))
    beside = (u.max(axis=1) < 0) | (u.min(axis=1) > camera.width_px - 1) | (rows[:, 1] < 0) | (rows[:, 0] > last)
    return np.clip(rows, 0, last).astype(np.intp), (depth > NEAR_M).any(axis=1) & ~(whole & beside)


def _spans(camera: Intrinsics, planes: _Planes) -> tuple[Ints, Ints, Ints, Ints]:
    """Return index in `planes`, row, first and last column of every run of pixels inside a triangle."""
    count = planes.rows[:, 1] - planes.rows[:, 0] + 1
    at = np.repeat(np.arange(len(count)), count)
    row = planes.rows[at, 0] + np.arange(len(at)) - (np.cumsum(count) - count)[at]
    # In a row each edge function is linear in the column; its zero bounds the run on one side.
    slope = planes.edges[at, :, 0]
    rest = planes.edges[at, :, 1] * row[:, None] + planes.edges[at, :, 2]
    with np.errstate(divide="ignore", invalid="ignore"):
        zero = -rest / slope
    low = np.where(slope > 0, zero, -np.inf).max(axis=1, initial=0.0)
    high = np.where(slope < 0, zero, np.inf).min(axis=1, initial=camera.width_px - 1.0)
    first, last = np.ceil(low), np.floor(high)
    inside = (first <= last) & ~((slope == 0) & (rest < 0)).any(axis=1)
    return at[inside], row[inside], first[inside].astype(np.intp), last[inside].astype(np.intp)


def _nearest(pixel: Ints, nearness: Array, at: Ints, pixels: int) -> tuple[Array, Ints]:
    """Return 1/depth (P,) of the nearest triangle in each pixel, 0 for none, and its index in the planes, -1 for none.

    Of two triangles at the same depth, the later one is visible.
    """
    nearness = np.where(nearness <= 1 / NEAR_M, nearness, 0.0)
    nearest, shown = np.zeros(pixels), np.full(pixels, -1)
    np.maximum.at(nearest, pixel, nearness)
    wins = (nearness == nearest[pixel]) & (nearness > 0)
    shown[pixel[wins]] = at[wins]
    return nearest, shown


def _seen(camera: Intrinsics, planes: _Planes, triangles: Triangles, nearest: Array, shown: Ints) -> VisibleTriangles:
    hit = np.flatnonzero(shown >= 0)
    at, depth = shown[hit], 1 / nearest[hit]
    row, column = np.divmod(hit, camera.width_px)
    over_depth = np.einsum("tck,tcj->jkt", planes.weights, triangles.uv_m[planes.index])
    triangle, depth_m, uv_m = np.full(len(shown), -1), np.full(len(shown), np.inf), np.zeros((len(shown), 2))
    triangle[hit], depth_m[hit] = planes.index[at], depth
    for axis, (a, b, c) in enumerate(over_depth):
        uv_m[hit, axis] = (a[at] * column + b[at] * row + c[at]) * depth
    shape = camera.height_px, camera.width_px
    return VisibleTriangles(triangle.reshape(shape), depth_m.reshape(shape), uv_m.reshape(*shape, 2))
