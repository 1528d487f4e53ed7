"""Lens distortion: the radial and tangential model of Brown and Conrady as OpenCV writes it, and its inverse.

Coordinates are those of rays, x / z and y / z in the optical frame (x right, y down, z forward). The equations stand in
OpenCV's "Camera Calibration and 3D Reconstruction"; its denominators and thin prism are left out.
"""

from typing import Protocol

import numpy as np

from symolo.core.arrays import Array
from symolo.core.geometry.fisheye import Fisheye, FisheyeSettings

Coefficients = tuple[float, float, float, float, float]
"""k1, k2, p1, p2, k3: OpenCV's order, which ROS calls `plumb_bob`."""
NO_DISTORTION: Coefficients = (0.0, 0.0, 0.0, 0.0, 0.0)

_STEPS = 24
_NEWTON_STEPS = 3
_LAST_NEWTON_STEPS = 15
"""Number of Newton steps at full distortion; the method is slow near a fold."""
_BORDER_POINTS = 65
"""Number of points on each side of the image."""


class Distortion(Protocol):
    """Radial (k) and tangential (p) coefficients, as the configuration of a robot has them."""

    k1: float
    k2: float
    p1: float
    p2: float
    k3: float


class CameraOptics(Protocol):
    """Lens and image sensor of a camera, as the configuration of a robot has them."""

    focal_length_mm: float
    sensor_width_mm: float
    principal_point_right_mm: float
    principal_point_down_mm: float

    @property
    def distortion(self) -> Distortion: ...

    @property
    def fisheye(self) -> FisheyeSettings | None: ...


class MountedCamera(CameraOptics, Protocol):
    """A camera on a robot, as the configuration of a robot has it; the camera's x and y are those of R."""

    x_m: float
    y_m: float
    height_above_base_m: float
    pitch_down_deg: float
    yaw_left_deg: float
    roll_deg: float


def coefficients(camera: CameraOptics) -> Coefficients:
    lens = camera.distortion
    return lens.k1, lens.k2, lens.p1, lens.p2, lens.k3


def distorted(lens: Coefficients, rays: Array) -> Array:
    """Return the points (N, 2) on the sensor, in units of the focal length, that rays (N, 2) meet."""
    k1, k2, p1, p2, k3 = lens
    x, y = rays[:, 0], rays[:, 1]
    r2 = x * x + y * y
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    u = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
    v = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
    return np.stack([u, v], axis=1)


def undistorted(lens: Coefficients, points: Array) -> Array:
    """Return the rays (N, 2) that meet the sensor in points (N, 2); NaN where no ray does, or more than one.

    Rays are followed from the axis outwards by Newton's method, so that a lens that folds the image is detected.
    """
    rays = np.zeros_like(points)
    whole = np.ones(len(points), bool)
    with np.errstate(all="ignore"):  # rays that diverge become NaN
        for step in range(1, _STEPS + 1):
            before = rays
            rays = refined(lens, points * (step / _STEPS), rays, _NEWTON_STEPS if step < _STEPS else _LAST_NEWTON_STEPS)
            for share in (0.5, 1.0):  # Newton may jump over a fold
                a, b, d = _slopes(lens, before + share * (rays - before))
                whole &= (a * d - b * b > 0) & (a + d > 0)
        missed = np.abs(distorted(lens, rays) - points).max(axis=1, initial=0)
        whole &= missed < 1e-9
    return np.where(whole[:, None], rays, np.nan)


def refined(lens: Coefficients, points: Array, near: Array, newton_steps: int) -> Array:
    """Return the rays (N, 2) that meet the sensor in points (N, 2), by Newton steps from rays (N, 2) that nearly do."""
    rays = near
    for _ in range(newton_steps):
        a, b, d = _slopes(lens, rays)
        u, v = (points - distorted(lens, rays)).T
        rays = rays + np.stack([d * u - b * v, a * v - b * u], axis=1) / (a * d - b * b)[:, None]
    return rays


def _slopes(lens: Coefficients, rays: Array) -> tuple[Array, Array, Array]:
    """Return du/dx, du/dy = dv/dx and dv/dy of `distorted`."""
    k1, k2, p1, p2, k3 = lens
    x, y = rays[:, 0], rays[:, 1]
    r2 = x * x + y * y
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    growth = 2 * (k1 + r2 * (2 * k2 + r2 * 3 * k3))
    return (
        radial + growth * x * x + 2 * p1 * y + 6 * p2 * x,
        growth * x * y + 2 * p1 * x + 2 * p2 * y,
        radial + growth * y * y + 6 * p1 * y + 2 * p2 * x,
    )


def border_rays(lens: Coefficients, low: tuple[float, float], high: tuple[float, float]) -> Array:
    """Return rays (N, 2) that meet the border of a sensor with these corners; NaN as for `undistorted`."""
    x, y = (np.linspace(low[i], high[i], _BORDER_POINTS) for i in (0, 1))
    sides = [np.column_stack(np.broadcast_arrays(x, edge)) for edge in (low[1], high[1])]
    sides += [np.column_stack(np.broadcast_arrays(edge, y)) for edge in (low[0], high[0])]
    return undistorted(lens, np.concatenate(sides))


def lens_problem(camera: CameraOptics, width_px: int, height_px: int) -> str:
    """Return why no image of this size can be made through the camera's lens; empty if one can.

    For a lens that does not fold, the pinhole image is little more than twice as wide and high as the image.
    """
    if camera.fisheye is not None:
        return Fisheye.from_settings(camera.fisheye).problem()
    if coefficients(camera) == NO_DISTORTION:
        return ""
    half = 0.5 * camera.sensor_width_mm / camera.focal_length_mm * np.array([1.0, height_px / width_px])
    axis = np.array([camera.principal_point_right_mm, camera.principal_point_down_mm]) / camera.focal_length_mm
    rays = border_rays(coefficients(camera), tuple(-half - axis), tuple(half - axis))
    if np.isnan(rays).any():
        return "the lens folds the image back on itself before its border, so that no ray belongs to a pixel there"
    return ""
