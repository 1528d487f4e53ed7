"""The generated part of the firmware: the table of the state machine, the robot's numbers, and its paths in flash.

It is a pure function of the robot's configuration and the shipped table; the rest of the firmware is hand-written C.
"""

import math
from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel

from configs.schema.controller import Controller
from configs.schema.robot import RobotConfig
from physics.control.curves import FULL_SEARCH_RAD, IN_THE_MIDDLE
from physics.control.following import MAX_ERROR
from physics.control.paths import AvoidancePath, curve_path, straight_path
from physics.control.transitions import Transition, load_transitions
from symolo.core.errors import InputError
from symolo.dataset.codes import State

WHITE = 255
"""Value of a line channel on the wire at full reflectance."""
MAX_POINTS = 8000
"""Largest number of points of a path: with 16 bits each for x and y they fit into the 32 KB of a table of avr-gcc."""
MAX_SET_POINT_RAD_S = 32.767
"""Largest set point of a wheel, sent as 16 bits in mrad/s."""
_COUNTS_PER_LINE = 16

# Fields of the controller's configuration that are compared with a range: (path, whether readings below it count).
_RANGES_BELOW = (
    "wall.found_within_m",
    "corner.front_below_m",
    "avoidance.front_below_m",
    "avoidance.free_side_beyond_m",
    "avoidance.behind_beyond_m",
    "avoidance.curves.side_below_m",
    "avoidance.curves.ahead_below_m",
    "avoidance.curves.both_below_m",
    "avoidance.curves.face.back_below_m",
    "avoidance.curves.face.seen_below_m",
)
_RANGES_ABOVE = ("wall.lost_beyond_m", "corner.front_clear_m")


def generate(robot: RobotConfig) -> dict[str, str]:
    """Return the generated files, text by name: states.h, transitions.h, settings.h and paths.h.

    Raises:
        InputError: The robot's numbers do not fit the board or the wire.
    """
    _check_fits(robot)
    return {
        "states.h": _states(),
        "transitions.h": _transitions(load_transitions()),
        "settings.h": _settings(robot),
        "paths.h": _paths(robot.controller),
    }


def _check_fits(robot: RobotConfig) -> None:
    points = robot.controller.avoidance.points
    if points > MAX_POINTS:
        what = "robot.controller.avoidance.points"
        raise InputError(what, got=points, allowed=f"up to {MAX_POINTS} for the firmware, whose flash holds the paths")
    drive = robot.drive
    for field, gains in (("line", robot.controller.line), ("wall.gains", robot.controller.wall.gains)):
        rim_m_s = gains.k1_m_s + 0.5 * drive.track_m * gains.k2_rad_s * MAX_ERROR
        set_point = rim_m_s / (0.5 * drive.wheel_diameter_m)
        if set_point > MAX_SET_POINT_RAD_S:
            what = f"robot.controller.{field}: wheel set points"
            allowed = f"up to {MAX_SET_POINT_RAD_S} rad/s for the firmware"
            raise InputError(what, got=round(set_point, 3), allowed=allowed, cure="lower k1_m_s or k2_rad_s")


def _header(name: str, about: str, lines: list[str]) -> str:
    guard = name.upper() + "_H"
    begin = [f"/* Made from the robot's configuration: {about} */", f"#ifndef {guard}", f"#define {guard}", ""]
    return "\n".join([*begin, *lines, "", "#endif", ""])


def _states() -> str:
    values = [f"    STATE_{state.name} = {int(state)}," for state in State]
    return _header("states", "the robot's states, with the numbers of data.csv.", ["enum state {", *values, "};"])


def _transitions(rows: tuple[Transition, ...]) -> str:
    lines = [
        '#include "conditions.h"',
        "",
        "/* configs/state_machine.yaml, row by row; the first that holds is taken. */",
        "static inline enum state next_by_table(enum state state, const struct view *view)",
        "{",
    ]
    for row in rows:
        among = " || ".join(f"state == STATE_{state.name}" for state in row.states)
        lines += [f"    if (({among}) && {_call(row)})", f"        return STATE_{row.to.name};"]
    return _header("transitions", "which state follows which, and when.", [*lines, "    return state;", "}"])


def _call(row: Transition) -> str:
    if not row.argument:
        return f"{row.condition}(view)"
    argument = f"STATE_{row.argument}" if row.argument in State.__members__ else f"SIDE_{row.argument.upper()}"
    return f"{row.condition}(view, {argument})"


def _settings(robot: RobotConfig) -> str:
    drive, controller = robot.drive, robot.controller
    metres_per_count = math.pi * drive.wheel_diameter_m / robot.encoder.counts_per_revolution
    lines = [
        f"#define HAS_CURVES {int(controller.avoidance.curves is not None)}",
        f"#define LINE_THRESHOLD {_whole_below(robot.line_sensor.threshold, 1.0 / WHITE)} /* of {WHITE} */",
        _define("METRES_PER_COUNT", metres_per_count),
        _define("RADIANS_PER_COUNT", metres_per_count / drive.track_m),
        _define("TRACK_M", drive.track_m),
        _define("WHEEL_RADIUS_M", 0.5 * drive.wheel_diameter_m),
        _define("MAX_ERROR", MAX_ERROR),
        _define("CURVES_FULL_SEARCH_RAD", FULL_SEARCH_RAD),
        _define("CURVES_IN_THE_MIDDLE", IN_THE_MIDDLE),
        "",
    ]
    numbers = dict(_numbers(controller))
    lines += [_define(_macro(path), value) for path, value in numbers.items()]
    lines += ["", "/* Ranges in millimetres: a reading counts as nearer where it is below ..., */"]
    lines += [
        f"#define {_macro(path)}M {_millimetres_below(numbers[path])}" for path in _RANGES_BELOW if path in numbers
    ]
    lines += ["", "/* and as farther where it is above. */"]
    lines += [
        f"#define {_macro(path)}M {_whole_below(math.nextafter(numbers[path], math.inf), 0.001) - 1}"
        for path in _RANGES_ABOVE
    ]
    if controller.avoidance.curves is not None:
        lines += ["", *_facing(controller)]
    return _header("settings", "the numbers of its controller, in SI units.", lines)


def _facing(controller: Controller) -> list[str]:
    """Return the readings between which an obstacle is at the distance where the curve paths begin."""
    avoidance, curves = controller.avoidance, controller.avoidance.curves
    if curves is None:
        return []
    middle, tolerance = avoidance.front_below_m, curves.face.tolerance_m
    stop = _millimetres_below(middle + 2.0 * tolerance) + 1
    within = [n for n in range(stop) if abs(n * 0.001 - middle) < tolerance] or [_millimetres_below(middle)]
    return [
        f"#define AVOIDANCE_CURVES_FACE_EDGE_MM {math.floor(curves.face.edge_m / 0.001 + 1e-9)}",
        f"#define FACING_NEAREST_MM {within[0]}",
        f"#define FACING_FARTHEST_MM {within[-1]}",
    ]


def _numbers(section: BaseModel, path: str = "") -> Iterator[tuple[str, float]]:
    """Yield every number of the controller's configuration with its path."""
    for name in type(section).model_fields:
        value = getattr(section, name)
        if isinstance(value, BaseModel):
            yield from _numbers(value, f"{path}{name}.")
        elif isinstance(value, float):
            yield path + name, value


def _macro(path: str) -> str:
    return path.upper().replace(".", "_")


def _define(name: str, value: float) -> str:
    return f"#define {name} {float(value)!r}f"


def _millimetres_below(limit_m: float) -> int:
    return _whole_below(limit_m, 0.001)


def _whole_below(limit: float, step: float) -> int:
    """Return how many whole steps from 0 lie below the limit, in the arithmetic of the controller in Python."""
    # The division may be off in its last digit; the loop decides by the multiplication that the controller does.
    count = math.ceil(limit / step) + 2
    while count > 0 and not (count - 1) * step < limit:
        count -= 1
    return count


def _paths(controller: Controller) -> str:
    avoidance, curves = controller.avoidance, controller.avoidance.curves
    paths = {"STRAIGHT": straight_path(avoidance, "left")}
    if curves is not None:
        paths["INNER"] = curve_path(curves.inner, avoidance.points, "left")
        paths["OUTER"] = curve_path(curves.outer, avoidance.points, "left")
    per_m = _units_per_m(paths)
    lines = [
        '#include "flash.h"',
        "",
        "/* A power of two, so that no digit is lost on the way back to metres. */",
        f"#define PATH_UNITS_PER_M {per_m}.0f",
    ]
    for name, path in paths.items():
        lines += ["", *_path(name, path, per_m, avoidance.look_ahead_m)]
    return _header("paths", "paths round obstacles, for the left-hand side.", lines)


def _units_per_m(paths: Mapping[str, AvoidancePath]) -> int:
    farthest_m = max(float(np.abs(path.points).max()) for path in paths.values())
    return 2 ** math.floor(math.log2(32767.0 / farthest_m))


def _path(name: str, path: AvoidancePath, per_m: int, look_ahead_m: float) -> list[str]:
    count = len(path.points)
    ahead, window = (max(1, round(length / path.spacing_m)) for length in (look_ahead_m, 3 * look_ahead_m))
    units: NDArray[np.int64] = np.rint(path.points * per_m).astype(np.int64).ravel()
    rows = [
        "    " + " ".join(f"{value}," for value in units[begin : begin + _COUNTS_PER_LINE])
        for begin in range(0, 2 * count, _COUNTS_PER_LINE)
    ]
    return [
        f"#define {name}_COUNT {count}",
        f"#define {name}_BACK_BEGINS {path.back_begins}",
        _define(f"{name}_SPACING_M", path.spacing_m),
        f"#define {name}_AHEAD_POINTS {min(ahead, count)}",
        f"#define {name}_WINDOW_POINTS {min(window, count)}",
        f"static const int16_t {name}_POINTS[2 * {name}_COUNT] IN_FLASH = {{",
        *rows,
        "};",
    ]
