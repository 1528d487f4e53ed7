"""Signs that the units of a URDF file, or the sides of its wheels, are not those that were taken."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

from physics.robot.urdf_tree import UrdfTree
from symolo.core.errors import InputError

TRACK_M = (0.014, 1.4)
"""Distances of the wheels of a robot that can be scaled from the nominal one, by 0.1 to 10."""
WHOLE_TURN_RAD = 2.0 * math.pi + 0.01
MAX_RIM_M_S = 4.0
"""Speed of a wheel's rim that the motors of small robots do not reach."""
RPM = math.pi / 30.0


@dataclass(frozen=True)
class Ends:
    """Wheels of an axle, left and right."""

    joints: tuple[str, str]
    y_m: tuple[float, float]
    """Places in the frame of the root, whose y axis points to the left by REP 103."""


def check_size(track_m: float, where: str) -> None:
    """Refuse wheels that are too far apart or too close for a robot of this simulator.

    Raises:
        InputError: They are; the message names the unit in which they would not be.
    """
    low, high = TRACK_M
    if low <= track_m <= high:
        return
    fits = [(unit, per) for unit, per in (("millimetres", 1000), ("centimetres", 100)) if low <= track_m / per <= high]
    divide = " or ".join(f"in {unit}, divide them by {per}" for unit, per in fits)
    cure = f"a URDF has metres: if the lengths are {divide}" if fits else ""
    raise InputError(
        "distance of the wheels", where=where, got=f"{track_m:.4g} m", allowed=f"{low:g} to {high:g} m", cure=cure
    )


def angle_doubt(tree: UrdfTree) -> str:
    """Return that the angles of a file are probably in degrees; empty if they are not."""
    largest = tree.largest_angle_rad
    if largest < WHOLE_TURN_RAD:
        return ""
    return (
        f"rpy has angles up to {largest:.4g}, and a URDF has radians: if they are degrees, {largest:.4g} is "
        f"{math.radians(largest):.4f}"
    )


def suspicions(tree: UrdfTree, wheels: Ends, speed_rad_s: float | None, radius_m: float) -> Iterator[str]:
    """Yield a sentence for each sign that units or sides are wrong.

    Args:
        tree: The bodies.
        wheels: The wheels that were taken.
        speed_rad_s: Limit of their speed; None if the file has none.
        radius_m: Radius of a wheel.
    """
    if doubt := angle_doubt(tree):
        yield doubt
    if speed_rad_s is not None and speed_rad_s * radius_m > MAX_RIM_M_S:
        yield (
            f"velocity {speed_rad_s:g} of the wheels gives {speed_rad_s * radius_m:.3g} m/s, and a URDF has rad/s: if "
            f"it is in rpm, {speed_rad_s:g} is {speed_rad_s * RPM:.4g}"
        )
    (left, right), (left_m, right_m) = wheels.joints, wheels.y_m
    named = "right" in left.lower() and "left" in right.lower()
    if named or ("left" not in left.lower() and left_m < right_m):
        why = "its name says right" if named else f"it lies on the right in the file, at y {left_m:.4g} m"
        yield f"{left} is taken for the left wheel, but {why}; if it is the right one, exchange them in --wheels"
