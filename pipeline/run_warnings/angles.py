"""Angles of a scenario whose numbers are probably radians, though their fields are in degrees."""

import re
from collections.abc import Iterator
from math import degrees, pi, radians

from configs.schema.scenario import RunSpec
from pipeline.run_warnings.suspicion import Suspicion, settings_of
from sensors.ranging.lidar import LidarSettings

ROUND_RAD = {2: pi / 4.0, 3: pi / 12.0, 4: pi / 36.0}
"""Angle whose multiples are round, 45, 15 or 5 degrees, by the number of decimals from which on it counts. Things are
mounted at round angles, which in degrees have no decimals; many angles with two decimals are near a multiple of 15."""
CAMERA_PITCH = re.compile(r"robot\.camera\.pitch_down_deg|robot\.sensors\.\w+\.pitch_up_deg")
"""Angles that are round with two decimals, too, in steps of 5 degrees: they are large, or none at all."""
MIN_PITCH_RAD, MAX_PITCH_RAD = radians(9.0), pi / 2.0 + 0.01
SIDE_MOUNTS = ("robot.tof.mounts.left.yaw_deg", "robot.tof.mounts.right.yaw_deg")
MIN_SIDE_RAD, MAX_SIDE_RAD = 0.1, 2.0
"""Yaw of a side sensor that is probably in radians: in degrees, the sensor would look straight ahead."""
TOO_SMALL = (
    (r"robot\.(tof|sensors\.\w+)\.field_of_view_deg", pi / 2.0, "as degrees, the sensor sees a narrow beam"),
    (r"robot\.(tof|sensors\.\w+)\.beam_sigma_deg", 0.5, "as degrees, only the middle of the beam has a weight"),
    (r"look\.sun\.elevation_deg", pi / 2.0, "as degrees, the sun is at the horizon"),
)
"""Fields, the largest number that is probably in radians, and what it would mean in degrees."""
MAX_FINE_DEG = 2.0
"""Largest angle that is stated with decimals."""
MIN_RAYS, ROUNDING = 16, 0.02
"""Smallest number of rays of a lidar that looks around, and deviation of a rounded step from the exact one."""
_ANGLE = re.compile(r"(\w+\.)*((yaw|pitch|roll|azimuth|tilt)\w*|start|end|turn)_deg")


def in_radians(field: str, angle: float, reason: str = "") -> Suspicion:
    """Return the suspicion that the number of a field is in radians, with the number in degrees."""
    name = field.rpartition(".")[2]
    text = f"{field} {angle:g} looks like radians{f': {reason}' if reason else ''}"
    in_degrees = f"{degrees(angle):.0f}" if abs(degrees(angle)) > MAX_FINE_DEG else f"{degrees(angle):.2g}"
    return Suspicion(f"{field} in radians", f"{text}; if it is in radians, write {name}: {in_degrees}")


def settings_in_radians(spec: RunSpec) -> Iterator[Suspicion]:
    """Yield the angles of mounts, beams, arcs, obstacles, sun and lamps that are probably in radians."""
    for field, value in settings_of(spec):
        if isinstance(value, int) or not value:
            continue
        limit, reason = next((rest[1:] for rest in TOO_SMALL if re.fullmatch(rest[0], field)), (0.0, ""))
        beside = field in SIDE_MOUNTS and MIN_SIDE_RAD < abs(value) < MAX_SIDE_RAD
        is_round = _ANGLE.fullmatch(field) is not None and is_round_in_radians(value, field)
        if 0.0 < value <= limit:
            yield in_radians(field, value, reason)
        elif beside or is_round:
            yield in_radians(field, value)
    yield from _scans_in_radians(spec)


def _scans_in_radians(spec: RunSpec) -> Iterator[Suspicion]:
    """Yield the step between the rays of a lidar if all rays are within a few degrees, but not if it was drawn."""
    for name, lidar in spec.robot.sensors:
        field = f"robot.sensors.{name}.ray_step_deg"
        if isinstance(lidar, LidarSettings) and lidar.rays >= MIN_RAYS and field not in spec.drawn:
            angle = lidar.rays * abs(lidar.ray_step_deg)
            if angle <= 2.0 * pi * (1.0 + ROUNDING):
                reason = f"as degrees, all {lidar.rays} rays are within {angle:.2g} degrees"
                yield in_radians(field, lidar.ray_step_deg, reason)


def is_round_in_radians(angle: float, field: str) -> bool:
    """Return whether a number is a round angle up to a whole turn, in radians, to the last of its decimals."""
    decimals = len(f"{angle:.6g}".partition(".")[2])
    round_rad = ROUND_RAD.get(min(decimals, max(ROUND_RAD)))
    if decimals == min(ROUND_RAD) and CAMERA_PITCH.fullmatch(field) and MIN_PITCH_RAD < abs(angle) < MAX_PITCH_RAD:
        round_rad = pi / 36.0
    if round_rad is None or not 0.0 < abs(angle) < 2.0 * pi + 10.0**-decimals:
        return False
    multiple = round(abs(angle) / round_rad)
    return multiple > 0 and abs(abs(angle) - multiple * round_rad) < 10.0**-decimals
