"""The camera on the robot: intrinsics, poses and projection.

Frames: W the world, R the robot (middle of the axle, x forward, y left, z up), C the camera's optical frame of OpenCV
(x right, y down, z along the axis). X_AB is the pose of B in A, so that p_A = X_AB p_B.
"""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import Field

from symolo.core.arrays import Array
from symolo.core.geometry.fisheye import Fisheye
from symolo.core.geometry.lens import NO_DISTORTION, Coefficients, MountedCamera, coefficients, distorted, undistorted


def _is_none(lens: Fisheye | None) -> bool:
    return lens is None


@dataclass(frozen=True)
class Intrinsics:
    """Pixel (0, 0) is the middle of the first pixel, as in OpenCV."""

    width_px: int
    height_px: int
    fx_px: float
    fy_px: float
    cx_px: float
    cy_px: float
    distortion: Coefficients = NO_DISTORTION
    # Left out of JSON by default, so that a pinhole camera has the same bytes as in versions without fisheye lenses.
    fisheye: Annotated[Fisheye | None, Field(exclude_if=_is_none)] = None
    """Fisheye lens; None for a pinhole camera with `distortion`."""


@dataclass(frozen=True)
class Shutter:
    """When an image is exposed: the middle of its middle row at the view's time, every row equally long."""

    exposure_s: float = 0.0
    read_out_s: float = 0.0
    """Time from the start of the first row to the start of the row that would follow the last one."""

    def row_opens_s(self, row: int, rows: int) -> float:
        """Return when the exposure of one of the image's rows begins, relative to the view's time."""
        return ((row + 0.5) / rows - 0.5) * self.read_out_s - 0.5 * self.exposure_s


def intrinsics(camera: MountedCamera, width_px: int, height_px: int) -> Intrinsics:
    """Return the intrinsics of a camera with square pixels for images of a size.

    The field of view of a fisheye lens spans the width of the image.
    """
    pixels_per_mm = width_px / camera.sensor_width_mm
    focal_px = width_px * camera.focal_length_mm / camera.sensor_width_mm
    fisheye, distortion = None, coefficients(camera)
    if camera.fisheye is not None:
        fisheye, distortion = Fisheye.from_settings(camera.fisheye), NO_DISTORTION
        focal_px = 0.5 * width_px / float(fisheye.radius(np.array(fisheye.half_field_rad)))
    cx_px = 0.5 * (width_px - 1) + camera.principal_point_right_mm * pixels_per_mm
    cy_px = 0.5 * (height_px - 1) + camera.principal_point_down_mm * pixels_per_mm
    return Intrinsics(width_px, height_px, focal_px, focal_px, cx_px, cy_px, distortion, fisheye)


def matrix_K(camera: Intrinsics) -> Array:
    """Return the camera matrix (3, 3) [px]."""
    return np.array([[camera.fx_px, 0, camera.cx_px], [0, camera.fy_px, camera.cy_px], [0, 0, 1.0]])


def horizontal_field_of_view_rad(camera: MountedCamera) -> float:
    """Return the angle that the sensor's width covers, without distortion and with the axis in its middle."""
    return float(2 * np.arctan(0.5 * camera.sensor_width_mm / camera.focal_length_mm))


def pose_X_RC(camera: MountedCamera, base_height_m: float) -> Array:
    """Return the pose (4, 4) of the camera in R: pitched down, turned left, then rolled about its axis."""
    pitch, yaw, roll = np.radians([camera.pitch_down_deg, camera.yaw_left_deg, camera.roll_deg])
    left = np.array([-np.sin(yaw), np.cos(yaw), 0.0])
    forward = np.array([np.cos(pitch) * np.cos(yaw), np.cos(pitch) * np.sin(yaw), -np.sin(pitch)])
    right, down = -left, np.cross(forward, -left)
    X_RC = np.eye(4)
    rolled = [np.cos(roll) * right + np.sin(roll) * down, np.cos(roll) * down - np.sin(roll) * right]
    X_RC[:3, :3] = np.stack([*rolled, forward], axis=1) + 0.0  # no -0
    X_RC[:3, 3] = camera.x_m, camera.y_m, base_height_m + camera.height_above_base_m
    return X_RC


def project(camera: Intrinsics, X_WC: Array, p_W: Array) -> tuple[Array, Array]:
    """Return the pixels (N, 2) of points (N, 3) in W, and their depths (N,) along the axis [m].

    A point with a depth of zero or less is behind the camera, and its pixel is NaN. So is that of a point so far aside
    that the lens model would fold it back. For a fisheye lens, the depth is the distance from the lens, with a negative
    sign beyond the field of view.
    """
    p_C = (p_W - X_WC[:3, 3]) @ X_WC[:3, :3]
    if camera.fisheye is not None:
        on_sensor, distance = camera.fisheye.on_sensor(p_C), np.linalg.norm(p_C, axis=1)
        return pixels(camera, on_sensor), np.where(np.isnan(on_sensor[:, 0]), -distance, distance)
    depth = p_C[:, 2]
    safe = np.where(depth > 0, depth, np.nan)
    if camera.distortion == NO_DISTORTION:
        u = camera.fx_px * p_C[:, 0] / safe + camera.cx_px
        v = camera.fy_px * p_C[:, 1] / safe + camera.cy_px
        return np.stack([u, v], axis=1), depth
    rays = p_C[:, :2] / safe[:, None]
    on_sensor = distorted(camera.distortion, rays)
    # Far beyond the fold nothing comes back at all, which compares with no number.
    folded = ~(np.abs(undistorted(camera.distortion, on_sensor) - rays).max(axis=1) <= 1e-6)
    return np.where(folded[:, None], np.nan, pixels(camera, on_sensor)), depth


def pixels(camera: Intrinsics, on_sensor: Array) -> Array:
    """Return the pixels (N, 2) of points (N, 2) on the sensor in units of the focal length."""
    return on_sensor * (camera.fx_px, camera.fy_px) + (camera.cx_px, camera.cy_px)


def rays_of(camera: Intrinsics, pixels: Array) -> Array:
    """Return the rays (N, 2), x / z and y / z in C, that pixels (N, 2) of a pinhole camera see; NaN for none."""
    on_sensor = _on_sensor(camera, pixels)
    return on_sensor if camera.distortion == NO_DISTORTION else undistorted(camera.distortion, on_sensor)


def directions_of(camera: Intrinsics, pixels: Array) -> Array:
    """Return the directions (N, 3) in C that pixels (N, 2) see; NaN where the lens brings none.

    Their z is 1 for a pinhole camera; for a fisheye lens their length is 1.
    """
    if camera.fisheye is not None:
        return camera.fisheye.directions(_on_sensor(camera, pixels))
    return np.column_stack([rays_of(camera, pixels), np.ones(len(pixels))])


def _on_sensor(camera: Intrinsics, pixels: Array) -> Array:
    return (pixels - (camera.cx_px, camera.cy_px)) / (camera.fx_px, camera.fy_px)


def floor_points(camera: Intrinsics, X_WC: Array, pixels: Array) -> Array:
    """Return the floor points (N, 3) seen in pixels (N, 2); NaN where the ray never comes down."""
    rays_W = directions_of(camera, pixels) @ X_WC[:3, :3].T
    down = np.where(rays_W[:, 2] < 0, -rays_W[:, 2], np.nan)
    return X_WC[:3, 3] + rays_W * (X_WC[2, 3] / down)[:, None]
