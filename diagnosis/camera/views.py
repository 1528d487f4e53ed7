"""The pixels at which a camera that deviates from the nominal one sees points of the world.

The deviations are in tolerances, as one vector in the order of GEOMETRY; all 0 is the nominal camera.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from configs.schema.robot import Camera
from diagnosis.camera.case import CameraCase, Ints, SampleArrays
from diagnosis.camera.model import CameraParameter
from symolo.core.arrays import Array
from symolo.core.geometry.lens import distorted
from symolo.core.geometry.pinhole import Intrinsics, intrinsics, pixels, pose_X_RC
from symolo.core.geometry.poses import pose_X_WR

RATE_OVER_S = 0.01
"""Time before and after an image over which the robot moves evenly."""
MOUNT, LENS, CLOCK = "a bent or badly printed mount", "another lens, or one that was focused again", "a late time stamp"

GEOMETRY = (
    CameraParameter("pitch_down", "deg", 0.2, "the camera looks further down than in the simulation", MOUNT),
    CameraParameter(
        "height", "m", 0.0005, "the camera sits higher than in the simulation", "another mount, wheels or tyres"
    ),
    CameraParameter("focal_length_scale", "1", 0.005, "f_true = scale * f: the image shows less of the scene", LENS),
    CameraParameter("yaw_left", "deg", 0.2, "the camera looks further to the left", MOUNT),
    CameraParameter("roll", "deg", 0.2, "the camera is turned clockwise about its axis, seen from behind", MOUNT),
    CameraParameter("forward", "m", 0.0005, "the camera sits further ahead", MOUNT),
    CameraParameter("left", "m", 0.0005, "the camera sits further to the left", MOUNT),
    CameraParameter("principal_point_right", "1", 0.003, "the optical axis is further right, in image widths", LENS),
    CameraParameter("principal_point_down", "1", 0.003, "the optical axis is further down, in image widths", LENS),
    CameraParameter("k1", "1", 0.01, "radial distortion: below 0 barrel, above 0 pincushion", LENS),
    CameraParameter("k2", "1", 0.01, "radial distortion of the fourth power", LENS),
    CameraParameter("time_offset", "s", 0.002, "images are exposed later than their stamps say", CLOCK),
    CameraParameter(
        "read_out", "s", 0.001, "rolling shutter: the bottom row is exposed later than the top", "another sensor"
    ),
    CameraParameter("line_width", "m", 0.0003, "the line is wider than on the map", "another tape", can_be_named=False),
)


@dataclass(frozen=True)
class EdgePoints(SampleArrays):
    """Points on the edges of the line, each of which is searched in one image."""

    frame: Ints
    """(N,), index of the frame."""
    on_line: Array
    """(N, 2), x [m], y [m] in W, on the middle of the line."""
    outwards_W: Array
    """(N, 2), unit vector in W from the middle of the line over the edge."""


def deviating(case: CameraCase, x: Sequence[float]) -> tuple[Camera, float]:
    """Return the camera with these deviations (P,), and the time [s] between the stamp of an image and its exposure."""
    d = {parameter.name: value * parameter.tolerance for parameter, value in zip(GEOMETRY, x, strict=True)}
    nominal, lens = case.camera, case.camera.distortion
    moved = {
        "pitch_down_deg": nominal.pitch_down_deg + d["pitch_down"],
        "yaw_left_deg": nominal.yaw_left_deg + d["yaw_left"],
        "roll_deg": nominal.roll_deg + d["roll"],
        "height_above_base_m": nominal.height_above_base_m + d["height"],
        "x_m": nominal.x_m + d["forward"],
        "y_m": nominal.y_m + d["left"],
        "focal_length_mm": nominal.focal_length_mm * float(np.exp(d["focal_length_scale"])),
        "principal_point_right_mm": nominal.principal_point_right_mm
        + d["principal_point_right"] * nominal.sensor_width_mm,
        "principal_point_down_mm": nominal.principal_point_down_mm
        + d["principal_point_down"] * nominal.sensor_width_mm,
        "distortion": lens.model_copy(update={"k1": lens.k1 + d["k1"], "k2": lens.k2 + d["k2"]}),
        "read_out_s": nominal.read_out_s + d["read_out"],
    }
    return nominal.model_copy(update=moved), d["time_offset"]


@dataclass(frozen=True)
class CameraView:
    """A camera with deviations that moves along the path."""

    case: CameraCase
    x: Array
    """(P,), deviations in tolerances."""

    def pixels(self, points: EdgePoints, pose_errors: Array | None = None) -> Array:
        """Return the pixels (N, 2) of the points; NaN behind the camera.

        Args:
            points: Points on the edges of the line.
            pose_errors: (N, 3), deviations of the robot from its pose: ahead [m], to the left [m], turned [rad].
        """
        case = self.case
        camera, late_s = deviating(case, self.x.tolist())
        lens = intrinsics(camera, *case.size_px)
        X_RC = pose_X_RC(camera, case.robot.chassis.base_height_m)
        widening = GEOMETRY[-1].tolerance * float(self.x[-1])
        half = 0.5 * (case.arena.line.width_m + widening)
        floor = points.on_line + half * points.outwards_W
        p_W = np.column_stack([floor, np.zeros(len(floor))])
        t_s = np.array([frame.t_s for frame in case.frames]) + late_s
        around = case.path.poses_at(np.concatenate([t_s - RATE_OVER_S, t_s, t_s + RATE_OVER_S]))
        before, here, after = np.split(around, 3)
        poses = here[points.frame]
        seen = _projected(p_W, _shifted(poses, pose_errors), X_RC, lens)
        if camera.read_out_s:
            # The time of a row depends on the row, which depends on the pose at that time: one correction of the first
            # result is enough, since a robot moves by a few pixels at most while an image is read out.
            rows = np.nan_to_num(seen[:, 1], nan=0.5 * lens.height_px)
            share = np.clip((rows + 0.5) / lens.height_px, 0.0, 1.0) - 0.5
            rates = ((after - before) / (2.0 * RATE_OVER_S))[points.frame]
            poses = poses + (share * camera.read_out_s)[:, None] * rates
            seen = _projected(p_W, _shifted(poses, pose_errors), X_RC, lens)
        return seen

    def floor_X_WC(self, frame: int) -> Array:
        """Return the pose (4, 4) of the camera at the middle of an exposure."""
        camera, late_s = deviating(self.case, self.x.tolist())
        t_s = np.array([self.case.frames[frame].t_s + late_s])
        x_m, y_m, yaw_rad = self.case.path.poses_at(t_s)[0].tolist()
        return pose_X_WR(x_m, y_m, yaw_rad) @ pose_X_RC(camera, self.case.robot.chassis.base_height_m)


def _shifted(poses: Array, errors: Array | None) -> Array:
    """Return the poses (N, 3) with errors ahead, to the left and in heading, if there are any."""
    if errors is None:
        return poses
    c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    ahead, left, turned = errors.T
    return poses + np.column_stack([c * ahead - s * left, s * ahead + c * left, turned])


def _projected(p_W: Array, poses: Array, X_RC: Array, lens: Intrinsics) -> Array:
    """Return pixels (N, 2) of points (N, 3), each with its robot pose, (N, 3)."""
    c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    x, y = (p_W[:, :2] - poses[:, :2]).T
    p_R = np.column_stack([c * x + s * y, c * y - s * x, p_W[:, 2]])
    p_C = (p_R - X_RC[:3, 3]) @ X_RC[:3, :3]
    depth = p_C[:, 2]
    rays = p_C[:, :2] / np.where(depth > 0.01, depth, np.nan)[:, None]
    # No lens folds within the image, so the search for folds in `pinhole.project` is not needed.
    return pixels(lens, distorted(lens.distortion, rays))
