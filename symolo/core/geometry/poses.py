"""Poses in the plane and in space. X_AB is the pose of frame B in frame A, so that p_A = X_AB p_B."""

from math import atan2, hypot

import numpy as np

from symolo.core.arrays import Array

Row4 = tuple[float, float, float, float]
Matrix4 = tuple[Row4, Row4, Row4, Row4]
"""(4, 4) homogeneous transform, row by row."""
PlanarPose = tuple[float, float, float]
"""x [m], y [m], yaw [rad] in W, of a frame on the floor."""
_POLE = 1e-9
"""Cosine of the pitch below which roll and yaw turn about the same axis."""


def as_rows(matrix: Array) -> Matrix4:
    """Return a (4, 4) matrix as a tuple of rows."""
    a, b, c, d = ((float(r[0]), float(r[1]), float(r[2]), float(r[3])) for r in matrix)
    return a, b, c, d


def pose_X_WR(x_m: float, y_m: float, yaw_rad: float) -> Array:
    """Return the (4, 4) pose in W of a frame R that stands on the floor."""
    c, s = np.cos(yaw_rad), np.sin(yaw_rad)
    return np.array([[c, -s, 0, x_m], [s, c, 0, y_m], [0, 0, 1, 0], [0, 0, 0, 1.0]])


def transform_of(xyz: tuple[float, float, float], rpy: tuple[float, float, float]) -> Array:
    """Return the (4, 4) pose of an origin [m], and roll, pitch, yaw [rad] about the fixed axes x, y, z, as in URDF."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    pose = np.eye(4)
    pose[:3, :3] = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    pose[:3, 3] = xyz
    return pose


def mounted(place_m: tuple[float, float, float], yaw_rad: float, pitch_up_rad: float, roll_rad: float = 0.0) -> Array:
    """Return the pose (4, 4) in R of a frame that is turned to the left, then tilted upwards, then rolled about x.

    A positive roll is clockwise as seen from behind.
    """
    return transform_of(place_m, (roll_rad, -pitch_up_rad, yaw_rad))


def roll_pitch_yaw(rotation: Array) -> tuple[float, float, float]:
    """Return the angles [rad] of a (3, 3) rotation, Rz(yaw) Ry(pitch) Rx(roll); an upright pitch has roll 0."""
    r = rotation
    level = hypot(r[0, 0], r[1, 0])
    pitch = atan2(-r[2, 0], level)
    if level < _POLE:
        return 0.0, pitch, atan2(-r[0, 1], r[1, 1]) + 0.0
    return atan2(r[2, 1], r[2, 2]) + 0.0, pitch + 0.0, atan2(r[1, 0], r[0, 0]) + 0.0


def rotations_about_z(yaw_rad: Array) -> Array:
    """Return the rotation matrices (N, 3, 3) of angles (N,) about the z axis."""
    rotations = np.tile(np.eye(3), (len(yaw_rad), 1, 1))
    rotations[:, 0, 0] = rotations[:, 1, 1] = np.cos(yaw_rad)
    rotations[:, 1, 0] = np.sin(yaw_rad)
    rotations[:, 0, 1] = -rotations[:, 1, 0]
    return rotations


def rotations(quaternions: Array) -> Array:
    """Return the rotation matrices (N, 3, 3) of quaternions (N, 4), x, y, z, w, of any length but 0."""
    x, y, z, w = (quaternions / np.linalg.norm(quaternions, axis=1)[:, None]).T
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )
    return np.moveaxis(np.array(rows), -1, 0)


def quaternions(rotations: Array) -> Array:
    """Return the unit quaternions (N, 4), x, y, z, w with w >= 0, of rotation matrices (N, 3, 3).

    The largest of the four components is computed first, so that no division loses digits (F. L. Markley, Unit
    Quaternion from Rotation Matrix, Journal of Guidance, Control, and Dynamics 31, 2008). Of the two quaternions of
    half a turn, the one whose first component that is not zero is positive.
    """
    trace = np.trace(rotations, axis1=1, axis2=2)
    diagonal = np.diagonal(rotations, axis1=1, axis2=2)
    largest = np.argmax(np.column_stack((diagonal, trace)), axis=1)
    result = np.empty((len(rotations), 4))
    for n, (R, i) in enumerate(zip(rotations, largest.tolist(), strict=True)):
        if i == 3:
            result[n] = R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1], 1 + trace[n]
        else:
            j, k = (i + 1) % 3, (i + 2) % 3
            result[n, i] = 1 - trace[n] + 2 * R[i, i]
            result[n, j] = R[j, i] + R[i, j]
            result[n, k] = R[k, i] + R[i, k]
            result[n, 3] = R[k, j] - R[j, k]
    result /= np.linalg.norm(result, axis=1)[:, None]
    signs = np.sign(result[:, [3, 0, 1, 2]])
    first = signs[np.arange(len(signs)), np.argmax(signs != 0, axis=1)]
    return result * first[:, None]
