"""Small patches of plain floor or line that a measured image and the simulated one of the same place both show."""

from dataclasses import dataclass

import cv2
import numpy as np

from diagnosis.camera.case import CameraCase, CameraFrame, ImagePixels, Ints, SampleArrays
from diagnosis.camera.views import CameraView, EdgePoints, deviating
from diagnosis.measured.channel import Mask
from symolo.core.arrays import Array
from symolo.core.geometry.pinhole import floor_points, intrinsics

COLUMNS, ROWS = 16, 12
"""Size of the grid of places at which floor is searched in an image."""
HALF = 1 / 80
"""Half of a patch's side, as a share of the image's width."""
CLEAR = 3.0
"""Distance of a patch of floor from the line, in half sides of a patch."""
MAX_UNEVEN = 0.12
"""Largest standard deviation within a patch of floor, as a share of its mean."""
BURNT, BLACK = 0.97, 0.012
"""Means of a channel, from 0 to 1, beyond which it is cut off and contains nothing."""
WALL_CLEAR_M = 0.03
"""Distance from a wall or an obstacle within which its foot and its shadow may be seen."""
SMOOTH_KERNEL = np.outer([1.0, -2.0, 1.0], [1.0, -2.0, 1.0]) / 6.0
"""Immerkaer, Fast noise variance estimation, CVIU 64 (1996) 300-302: blind to planes, of unit gain for white noise."""


@dataclass(frozen=True)
class FloorPatches(SampleArrays):
    """Patches that a measured and a simulated image both show."""

    frame: Ints
    """(N,), index of the image."""
    measured: Array
    """(N, 3), means of the measured values, from 0 to 1."""
    simulated: Array
    """(N, 3), means of the simulated values, from 0 to 1."""
    at: Array
    """(N, 2), pixels in the measured image."""
    nominal_at: Array
    """(N, 2), pixels in the simulated image."""
    roughness: Array
    """(N, 2), variance from pixel to pixel of green from 0 to 1, measured and simulated."""
    on_line: Mask
    """(N,), patches of the line; the others are of the floor."""


def floor_patches(case: CameraCase, x: Array) -> FloorPatches:
    """Return the patches of all images that have a simulated one; the measured camera has deviations x (P,)."""
    real, nominal = CameraView(case, x), CameraView(case, np.zeros_like(x))
    parts = [
        _frame_patches(k, frame, frame.simulated, real, nominal)
        for k, frame in enumerate(case.frames)
        if frame.simulated is not None
    ]
    return FloorPatches.joined(parts)


def _frame_patches(
    k: int, frame: CameraFrame, simulated: ImagePixels, real: CameraView, nominal: CameraView
) -> FloorPatches:
    case, (width, height) = real.case, real.case.size_px
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
    near_px = _clear_px(case, real, k, points)
    size = np.array([width - 1, height - 1])
    with np.errstate(invalid="ignore"):
        inside = np.where(on_line, near_px > half + 1.5, near_px > CLEAR * half)
        for pixels in (at, nominal_at):
            inside &= ((pixels >= half + 1) & (pixels <= size - half - 1)).all(axis=1)
    at, nominal_at, on_line = at[inside], nominal_at[inside], on_line[inside]
    mean, uneven, roughness = _read(frame.image, at, half)
    simulated_mean, simulated_uneven, simulated_roughness = _read(simulated, nominal_at, half)
    good = on_line | ((uneven < MAX_UNEVEN) & (simulated_uneven < MAX_UNEVEN))
    for values in (mean, simulated_mean):
        good &= (values < BURNT).all(axis=1) & (values > BLACK).all(axis=1)
    both = np.column_stack([roughness, simulated_roughness])
    return FloorPatches(np.full(len(at), k), mean, simulated_mean, at, nominal_at, both, on_line).some(good)


def _pixels(view: CameraView, frame: int, floor: Array) -> Array:
    """Return the pixels (N, 2) of points on the floor, which are edges of a line without width."""
    return view.pixels(EdgePoints(np.full(len(floor), frame), floor, np.zeros_like(floor)))


def _plain(case: CameraCase, floor: Array) -> Mask:
    """Return which floor points (N, 2) are far from walls and obstacles."""
    plain = np.ones(len(floor), bool)
    for box in case.arena.boxes:
        reach = 0.5 * float(np.hypot(*box.size[:2])) + WALL_CLEAR_M
        plain &= np.hypot(floor[:, 0] - box.center[0], floor[:, 1] - box.center[1]) > reach
    return plain


def _clear_px(case: CameraCase, view: CameraView, frame: int, floor: Array) -> Array:
    """Return the distance in the image of each floor point from the nearest edge of the line, (N,)."""
    line = case.arena.line
    edges = [
        piece.at(np.arange(0.0, piece.length_m, 0.005), aside * line.width_m)
        for piece in line.pieces
        for aside in (-0.5, 0.5)
    ]
    edge_pixels = _pixels(view, frame, np.concatenate(edges))
    edge_pixels = edge_pixels[np.isfinite(edge_pixels).all(axis=1)]
    return np.array([np.hypot(*(edge_pixels - pixel).T).min(initial=np.inf) for pixel in _pixels(view, frame, floor)])


def _read(image: ImagePixels, at: Array, half: int) -> tuple[Array, Array, Array]:
    """Return means (N, 3), relative standard deviation of green (N,) and its variance from pixel to pixel (N,)."""
    values = image.astype(np.float64) / 255.0
    box = (2 * half + 1, 2 * half + 1)
    mean = cv2.blur(values, box)
    square = cv2.blur(values[..., 1] ** 2, box)
    rough = cv2.blur(cv2.filter2D(values[..., 1], -1, SMOOTH_KERNEL) ** 2, (max(3, 2 * half - 1),) * 2)
    column, row = np.rint(at).astype(int).T
    means = np.asarray(mean[row, column], np.float64)
    uneven = np.sqrt(np.maximum(square[row, column] - means[:, 1] ** 2, 0.0)) / np.maximum(means[:, 1], 1e-6)
    return means, uneven, np.asarray(rough[row, column], np.float64)
