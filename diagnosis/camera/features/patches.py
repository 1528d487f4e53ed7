"""Small patches of plain floor or line that a measured image and the simulated one of the same place both show."""

from dataclasses import dataclass

import cv2
import numpy as np

from diagnosis.camera.case import CameraCase, ImagePixels, Ints, Mask
from diagnosis.camera.views import CameraView, EdgePoints, deviating
from symolo.core.arrays import Array
from symolo.core.geometry.pinhole import floor_points, intrinsics

COLUMNS, ROWS = 16, 12
"""Of the grid on which floor is looked for."""
HALF = 1 / 80
"""Of the image's width: half of a patch's side."""
CLEAR = 3.0
"""Halves of a patch, between it and an edge of the line."""
MAX_UNEVEN = 0.12
"""Standard deviation within a patch of floor, of its mean."""
BURNT, BLACK = 0.97, 0.012
"""Means of a channel beyond which it tells nothing."""
WALL_CLEAR_M = 0.03
SMOOTH_KERNEL = np.outer([1.0, -2.0, 1.0], [1.0, -2.0, 1.0]) / 6.0
"""Immerkaer, Fast noise variance estimation, CVIU 64 (1996) 300-302: blind to planes, of unit gain for white noise."""


@dataclass(frozen=True)
class FloorPatches:
    frame: Ints
    """(N,), place in the case's frames."""
    measured: Array
    """(N, 3) mean values from 0 to 1."""
    simulated: Array
    """(N, 3)."""
    at: Array
    """(N, 2) pixels in the measured image."""
    nominal_at: Array
    """(N, 2) pixels in the simulated image."""
    roughness: Array
    """(N, 2), variance of what changes from pixel to pixel in green, measured and simulated, of values from 0 to 1."""
    on_line: Mask


def floor_patches(case: CameraCase, x: Array) -> FloorPatches:
    """Of all images, the measured camera being the one with deviations x (P,)."""
    found = [
        _of_frame(case, CameraView(case, x), CameraView(case, np.zeros_like(x)), k) for k in range(len(case.frames))
    ]
    columns = [np.concatenate([one[i] for one in found]) for i in range(6)]
    frame = np.concatenate([np.full(len(one[0]), k) for k, one in enumerate(found)])
    measured, simulated, at, nominal_at, roughness, on_line = columns
    return FloorPatches(frame, measured, simulated, at, nominal_at, roughness, on_line.astype(bool))


def _of_frame(case: CameraCase, real: CameraView, nominal: CameraView, k: int) -> tuple[Array, ...]:
    frame, (width, height) = case.frames[k], case.size_px
    half = max(2, round(HALF * width))
    camera = deviating(case, real.x.tolist())[0]
    u = np.linspace(2 * half, width - 1 - 2 * half, COLUMNS)
    v = np.linspace(2 * half, height - 1 - 2 * half, ROWS)
    grid = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
    floor = floor_points(intrinsics(camera, width, height), real.floor_X_WC(k), grid)[:, :2]
    floor = floor[np.isfinite(floor).all(axis=1)]
    floor = floor[_plain(case, floor)]
    middle = np.concatenate([piece.at(np.arange(0.01, piece.length_m, 0.02)) for piece in case.arena.line.pieces])
    points = np.concatenate([floor, middle])
    on_line = np.arange(len(points)) >= len(floor)
    at, nominal_at = (_pixels(view, k, points) for view in (real, nominal))
    size = np.array([width - 1, height - 1])
    inside = np.ones(len(points), bool)
    for pixels in (at, nominal_at):
        with np.errstate(invalid="ignore"):
            inside &= ((pixels >= half + 1) & (pixels <= size - half - 1)).all(axis=1)
    near_px = _clear_px(case, real, k, points)
    with np.errstate(invalid="ignore"):
        inside &= np.where(on_line, near_px > half + 1.5, near_px > CLEAR * half)
    at, nominal_at, on_line = at[inside], nominal_at[inside], on_line[inside]
    if frame.simulated is None or not len(at):
        return np.empty((0, 3)), np.empty((0, 3)), np.empty((0, 2)), np.empty((0, 2)), np.empty((0, 2)), np.empty(0)
    mean, uneven, rough = _read(frame.image, at, half)
    its, its_uneven, its_rough = _read(frame.simulated, nominal_at, half)
    good = on_line | ((uneven < MAX_UNEVEN) & (its_uneven < MAX_UNEVEN))
    for values in (mean, its):
        good &= (values < BURNT).all(axis=1) & (values > BLACK).all(axis=1)
    roughness = np.column_stack([rough, its_rough])
    return mean[good], its[good], at[good], nominal_at[good], roughness[good], on_line[good].astype(np.float64)


def _pixels(view: CameraView, frame: int, floor: Array) -> Array:
    # A line without width: the points themselves.
    points = EdgePoints(np.full(len(floor), frame), floor, np.zeros_like(floor))
    return view.pixels(points)


def _plain(case: CameraCase, floor: Array) -> Mask:
    """Whether floor points are far from walls and obstacles, also from what these hide."""
    plain = np.ones(len(floor), bool)
    for box in case.arena.boxes:
        reach = 0.5 * float(np.hypot(*box.size[:2])) + WALL_CLEAR_M
        plain &= np.hypot(floor[:, 0] - box.center[0], floor[:, 1] - box.center[1]) > reach
    return plain


def _clear_px(case: CameraCase, view: CameraView, frame: int, floor: Array) -> Array:
    """How far, in the image, each floor point is from the nearest edge of the line."""
    line = case.arena.line
    edges = np.concatenate(
        [
            piece.at(np.arange(0.0, piece.length_m, 0.005), side * line.width_m)
            for piece in line.pieces
            for side in (-0.5, 0.5)
        ]
    )
    here, there = _pixels(view, frame, floor), _pixels(view, frame, edges)
    there = there[np.isfinite(there).all(axis=1)]
    if not len(there):
        return np.full(len(floor), np.inf)
    return np.array([np.hypot(*(there - one).T).min() for one in here]) if len(here) else np.empty(0)


def _read(image: ImagePixels, at: Array, half: int) -> tuple[Array, Array, Array]:
    """Means (N, 3), unevenness of green (N,) and its variance from pixel to pixel (N,)."""
    values = image.astype(np.float64) / 255.0
    box = (2 * half + 1, 2 * half + 1)
    mean = cv2.blur(values, box)
    square = cv2.blur(values[..., 1] ** 2, box)
    rough = cv2.blur(cv2.filter2D(values[..., 1], -1, SMOOTH_KERNEL) ** 2, (max(3, 2 * half - 1),) * 2)
    column, row = np.rint(at).astype(int).T
    means = np.asarray(mean[row, column], np.float64)
    uneven = np.sqrt(np.maximum(square[row, column] - means[:, 1] ** 2, 0.0)) / np.maximum(means[:, 1], 1e-6)
    return means, uneven, np.asarray(rough[row, column], np.float64)
