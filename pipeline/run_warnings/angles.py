"""Angles of a scenario whose numbers are probably radians, though their fields are in degrees."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from math import degrees, pi

from configs.schema.scenario import RunSpec

ROUND_RAD = {2: pi / 4.0, 3: pi / 12.0}
"""Angle whose multiples are round, 45 or 15 degrees, by the number of decimals from which on it counts. Things are
mounted at round angles, which in degrees have no decimals; many angles with two decimals are near a multiple of 15."""
SIDE_MOUNTS = ("robot.tof.mounts.left.yaw_deg", "robot.tof.mounts.right.yaw_deg")
MIN_SIDE_RAD, MAX_SIDE_RAD = 0.1, 2.0
"""Yaw of a side sensor that is probably in radians: in degrees, the sensor would look straight ahead."""
TOO_SMALL = {
    "robot.tof.field_of_view_deg": (pi / 2.0, "as degrees, the sensor sees a narrow beam"),
    "look.sun.elevation_deg": (pi / 2.0, "as degrees, the sun is at the horizon"),
}
"""Largest number of a field that is probably in radians, and what it would mean in degrees."""
_ANGLE = re.compile(r"(yaw|pitch|roll|azimuth|tilt)\w*_deg")


@dataclass(frozen=True)
class Suspicion:
    """Something suspicious about a run, before it is simulated."""

    about: str
    """Subject, which is the same for all runs whose texts differ in numbers alone."""
    text: str


def in_radians(field: str, angle: float, reason: str = "") -> Suspicion:
    """Return the suspicion that the number of a field is in radians, with the number in degrees."""
    name = field.rpartition(".")[2]
    text = f"{field} {angle:g} looks like radians{f': {reason}' if reason else ''}"
    return Suspicion(f"{field} in radians", f"{text}; if it is in radians, write {name}: {degrees(angle):.0f}")


def settings_in_radians(spec: RunSpec) -> Iterator[Suspicion]:
    """Yield the angles of mounts, obstacles, sun and lamps that are probably in radians, and were not drawn."""
    sections = {
        "robot": spec.robot.model_dump(exclude={"effects"}),
        "arena": {"obstacles": [{"yaw_deg": obstacle.yaw_deg} for obstacle in spec.arena.obstacles]},
        "look": spec.look.model_dump(exclude={"assets"}),
    }
    for field, value in _numbers(sections, ()):
        if field in spec.drawn or not value:
            continue
        limit, reason = TOO_SMALL.get(field, (0.0, ""))
        beside = field in SIDE_MOUNTS and MIN_SIDE_RAD < abs(value) < MAX_SIDE_RAD
        is_round = _ANGLE.fullmatch(field.rpartition(".")[2]) is not None and _is_round_in_radians(value)
        if 0.0 < value <= limit:
            yield in_radians(field, value, reason)
        elif beside or is_round:
            yield in_radians(field, value)


def _numbers(settings: object, path: tuple[str, ...]) -> Iterator[tuple[str, float]]:
    """Yield field path and value of each number with decimals."""
    if isinstance(settings, dict):
        for key, value in settings.items():
            yield from _numbers(value, (*path, str(key)))
    elif isinstance(settings, list | tuple):
        for index, value in enumerate(settings):
            yield from _numbers(value, (*path, str(index)))
    elif isinstance(settings, float):
        yield ".".join(path), settings


def _is_round_in_radians(angle: float) -> bool:
    """Return whether a number is a round angle up to a whole turn, in radians, to the last of its decimals."""
    decimals = len(f"{angle:.6g}".partition(".")[2])
    round_rad = ROUND_RAD.get(min(decimals, max(ROUND_RAD)))
    if round_rad is None or not 0.0 < abs(angle) < 2.0 * pi + 10.0**-decimals:
        return False
    multiple = round(abs(angle) / round_rad)
    return multiple > 0 and abs(abs(angle) - multiple * round_rad) < 10.0**-decimals
