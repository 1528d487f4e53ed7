"""Poses in space on the floor: which axes point up and forward, and what is lost of height and tilt."""

from dataclasses import dataclass

import numpy as np

from logs.axis import Axis
from logs.trajectories.base import axis_vector
from logs.trajectories.path_direction import MAX_UNJUDGED_CHORDS, angle_to_path, chords, share_forwards
from symolo.core.arrays import Array
from symolo.core.errors import InputError

LEVEL_SHARE = 0.2
"""Largest spread of heights as a share of that of places on the floor."""
MIN_HORIZONTAL = 0.3
"""Smallest horizontal part of a forward axis whose direction is still a heading."""
FOLLOWS_RAD = np.radians(30.0)
"""Largest median angle between a forward axis and the path of a body that drives along this axis."""
NOTABLE_HEIGHT_M, NOTABLE_TILT_RAD = 0.02, np.radians(5.0)
"""Range of heights and largest tilt of a robot on an even floor, with noise."""
MIN_WIDTH_M = 0.1
"""Smallest width of a path that shows in which plane it lies."""
PLACE_OF_CAMERA = (
    "the poses are those of a camera: x and y are its place, not that of the middle of the axle, because the log does"
    " not say where on the robot the camera is; give that with --body-at"
)
"""Warning for a body that has the axes of a camera."""
_NO_HEIGHT_M, _NO_TILT_RAD = 1e-6, 1e-5
"""Range of heights and largest tilt that are only rounding errors."""
_FORWARD_OF_UP = {
    Axis.Z: Axis.X,
    Axis.MINUS_Y: Axis.Z,
    Axis.Y: Axis.X,
    Axis.X: Axis.Y,
    Axis.MINUS_X: Axis.Y,
    Axis.MINUS_Z: Axis.X,
}
"""Forward axis by the upward axis: of bodies of REP 103, of optical frames of cameras, and of others. It is also the
axis of the log's world that becomes x of W."""


@dataclass(frozen=True)
class OnFloor:
    """Poses on the floor."""

    pose: Array
    """(N, 3), x [m], y [m], yaw [rad], unwrapped."""
    quantities: dict[str, str]
    changes: tuple[str, ...]
    warnings: tuple[str, ...]
    guesses: tuple[str, ...]
    is_rep_103: bool
    """Whether x of the body points forward and z upwards, so that tf has the places of sensors in R."""


def on_floor(
    p_OB: Array,
    R_OB: Array,
    where: str,
    *,
    up: Axis | None = None,
    forward: Axis | None = None,
    up_if_level: Axis = Axis.Y,
) -> OnFloor:
    """Return the poses of a robot on the floor W for poses of a body B in the world O of a log.

    The upward axis of O is z or the given one. The forward axis of B is the given one, or that among the horizontal
    axes of the body which follows the path.

    Args:
        p_OB: (N, 3), places [m].
        R_OB: (N, 3, 3), rotations.
        where: Place of the log for messages.
        up: Axis of O that points up; by default z, or `up_if_level` if the heights are those along y.
        forward: Axis of B that points forward.
        up_if_level: y or -y, whichever logs of this format have.

    Raises:
        InputError: The forward axis is vertical, so that it gives no heading.
    """
    guesses = []
    if up is None:
        up, reason = _upward(p_OB, R_OB, up_if_level)
        guesses += [reason] if reason else []
    R_WO = _world(up)
    p_WB, R_WB = p_OB @ R_WO.T, R_WO @ R_OB
    body_up = _body_up(R_WB)
    if forward is None:
        forward, reason = _forward(p_WB[:, :2], R_WB, body_up)
        guesses += [reason] if reason else []
    ahead = R_WB @ axis_vector(forward)
    horizontal = np.hypot(ahead[:, 0], ahead[:, 1])
    if np.median(horizontal) < MIN_HORIZONTAL:
        raise InputError(
            f"the axis {forward} of the body is vertical, so that it gives no heading",
            where=where,
            cure="name the forward axis with --forward, or the upward axis of the log with --up",
        )
    yaw_rad = np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0]))
    changes, warnings = _losses(p_WB, R_WB, body_up, up)
    warnings += _place_of_camera(forward, body_up)
    quantities = {"x, y": f"position, {up} up", "theta": f"direction of the body's {forward} axis"}
    pose = np.column_stack((p_WB[:, :2], yaw_rad))
    is_rep_103 = (forward, body_up) == (Axis.X, Axis.Z)
    return OnFloor(pose, quantities, tuple(changes), tuple(warnings), tuple(guesses), is_rep_103)


def _world(up: Axis) -> Array:
    """Return R_WO (3, 3), so that the axis `up` of O is z of W."""
    x, z = axis_vector(_FORWARD_OF_UP[up]), axis_vector(up)
    return np.stack([x, np.cross(z, x), z])


def _upward(p_OB: Array, R_OB: Array, if_level: Axis) -> tuple[Axis, str]:
    """Return the axis of O that points up, and the reason if it is not z.

    A robot on a floor keeps its height and turns about the vertical alone, so that the same axis of the body stays
    along the vertical.
    """
    spread_m = np.ptp(p_OB, axis=0)
    steady = np.linalg.norm(R_OB.mean(axis=0), axis=1)
    is_level = spread_m[1] < LEVEL_SHARE * min(spread_m[0], spread_m[2]) and spread_m[1] < spread_m[2]
    if not (is_level and steady[1] > steady[2]):
        return Axis.Z, ""
    return if_level, f"{if_level} is taken for the upward axis, since y is nearly constant; if it is not, use --up"


def _body_up(R_WB: Array) -> Axis:
    """Return the axis of the body that points up most of the time."""
    return max(Axis, key=lambda axis: float((R_WB @ axis_vector(axis))[:, 2].mean()))


def _forward(place: Array, R_WB: Array, body_up: Axis) -> tuple[Axis, str]:
    """Return the forward axis of the body, and a sentence if it is a guess from the path."""
    usual = _FORWARD_OF_UP[body_up]
    ends = chords(place)
    if len(ends) <= MAX_UNJUDGED_CHORDS:
        return usual, ""
    headings: dict[Axis, Array] = {axis: _yaw(R_WB, axis)[ends] for axis in Axis if axis.number != body_up.number}
    off_rad = {axis: angle_to_path(place[ends], yaw) for axis, yaw in headings.items()}
    if off_rad[usual] < FOLLOWS_RAD and share_forwards(place[ends], headings[usual]) >= 0.5:
        return usual, ""
    best = min(off_rad, key=lambda axis: (round(off_rad[axis], 6), -share_forwards(place[ends], headings[axis])))
    if off_rad[best] < FOLLOWS_RAD and best != usual:
        return best, f"the body's axis {best} is taken for forward, since the path follows it; if not, use --forward"
    return usual, ""


def _yaw(R_WB: Array, axis: Axis) -> Array:
    ahead = R_WB @ axis_vector(axis)
    return np.arctan2(ahead[:, 1], ahead[:, 0])


def _losses(p_WB: Array, R_WB: Array, body_up: Axis, up: Axis) -> tuple[list[str], list[str]]:
    """Return what is left out of the poses, and warnings where it is more than a robot on a floor has."""
    height_m = float(np.ptp(p_WB[:, 2]))
    body_z = R_WB @ axis_vector(body_up)
    upward = body_z.mean(axis=0)
    upward /= np.linalg.norm(upward)
    tilt_rad = float(np.arccos(np.clip(body_z @ upward, -1.0, 1.0)).max())
    if height_m < _NO_HEIGHT_M and tilt_rad < _NO_TILT_RAD:
        return [], []
    text = f"heights, which range over {height_m:.3g} m, and tilts of up to {np.degrees(tilt_rad):.2g} degrees"
    if height_m <= NOTABLE_HEIGHT_M and tilt_rad <= NOTABLE_TILT_RAD:
        return [f"{text} are left out"], []
    reason = _tilted_frame(p_WB, up) or _tilted_mount(height_m, body_z, body_up)
    return [f"{text} are left out"], [reason or f"the body does not move on an even floor: {text} are left out"]


def _tilted_frame(p_WB: Array, up: Axis) -> str:
    """Return a warning where the path lies in a plane that is not level; empty where it does not."""
    place = p_WB - p_WB.mean(axis=0)
    # A straight path lies in many planes.
    across_m = np.ptp(place[:, :2] @ np.linalg.svd(place[:, :2], full_matrices=False)[2][-1])
    if across_m < MIN_WIDTH_M:
        return ""
    slope = np.linalg.lstsq(place[:, :2], place[:, 2], rcond=1e-6)[0]
    tilt_rad = float(np.arctan(np.hypot(*slope)))
    if tilt_rad <= NOTABLE_TILT_RAD or np.ptp(place[:, 2] - place[:, :2] @ slope) > NOTABLE_HEIGHT_M:
        return ""
    return (
        f"the path lies in a plane that is tilted by {np.degrees(tilt_rad):.2g} degrees against the axis {up}, which is"
        " taken for upward: the frame of the log is probably that of a tilted body, such as a camera at its first"
        " image. Then places and headings here are wrong: turn the poses into a level frame before the import"
    )


def _tilted_mount(height_m: float, body_z: Array, body_up: Axis) -> str:
    """Return a warning where a body on a level path keeps a tilt; empty where it does not."""
    tilt_rad = np.arccos(np.clip(body_z[:, 2], -1.0, 1.0))
    if height_m > NOTABLE_HEIGHT_M or np.ptp(tilt_rad) > NOTABLE_TILT_RAD:
        return ""
    return (
        f"the body's axis {body_up} is tilted by {np.degrees(np.median(tilt_rad)):.2g} degrees against the vertical in"
        " all poses, as that of a body that is mounted with a tilt; the tilt is left out"
    )


def _place_of_camera(forward: Axis, body_up: Axis) -> list[str]:
    """Return a warning if the body has the axes of a camera (x right, y down, z forward)."""
    if (forward, body_up) != (Axis.Z, Axis.MINUS_Y):
        return []
    return [PLACE_OF_CAMERA]
