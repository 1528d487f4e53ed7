"""Warnings of a run that is probably not what its scenario was meant to make, with the suspected cause."""

from collections.abc import Iterator, Sequence
from math import atan2, cos, degrees, pi, radians, sin

import numpy as np

from configs.schema.controller import Controller
from configs.schema.robot import RobotConfig
from configs.schema.scenario import RunSpec
from physics.control.following import MAX_ERROR, follow
from physics.drivetrain.motor import MotorModel
from physics.drivetrain.wheel_loop import voltage_limit_V
from pipeline.run_warnings.angles import in_radians, is_round_in_radians, settings_in_radians
from pipeline.run_warnings.body_room import too_close
from pipeline.run_warnings.commanded_speed import commanded_in_other_units
from pipeline.run_warnings.inside_walls import inside_walls
from pipeline.run_warnings.own_shadow import shadows_without_robot
from pipeline.run_warnings.suspicion import Suspicion
from pipeline.run_warnings.unusual_settings import unusual_settings
from symolo.arena.footprints import wall_footprint
from symolo.arena.geometry import Arena, Line
from symolo.core.arrays import Array
from symolo.core.progress import plural
from symolo.core.tables.time_series import Recording
from symolo.dataset.codes import State

MIN_PATH_M = 0.01
"""Length of the path up to which the robot stands still."""
MAX_LOST_SHARE = 0.5
"""Share of the time in the line state without the line that is usual on an arena with gaps and obstacles."""
BESIDE_M = 0.1
"""Distance of the start from the line from which on it may be why the sensor does not see the line."""
ALONG_RAD, ACROSS_RAD = radians(10.0), radians(20.0)
"""Largest angle of a start along the line, and smallest angle of one that leads away from it."""
SPACING_M = 0.005
NO_LINE = (
    "the arena has no line that the built-in controller could follow; give arena.line its pieces, or name a controller "
    "of your own (scenario.controller)"
)


def plan_warnings(specs: Sequence[RunSpec]) -> tuple[str, ...]:
    """Return what is suspicious about runs before anything is simulated, each once with the runs that it concerns."""
    runs_of: dict[str, list[tuple[str, str]]] = {}
    for spec in specs:
        for suspicion in _suspicions(spec):
            runs_of.setdefault(suspicion.about, []).append((spec.key, suspicion.text))
    return tuple(_runs_text(runs) for runs in runs_of.values())


def planned_texts(spec: RunSpec) -> tuple[str, ...]:
    """Return what is suspicious about a run before it is simulated, which `plan_warnings` states."""
    return tuple(suspicion.text for suspicion in _suspicions(spec))


def start_to_line(spec: RunSpec) -> str:
    """Return distance and heading of the start, relative to the line, as text; empty in an arena without a line.

    The angle is that to the left of the line, which may be followed in both directions.
    """
    line = Arena.from_config(spec.arena).line
    if not line.pieces:
        return ""
    away_m, along = _nearest(line, spec)
    left_deg = (spec.start.yaw_deg - degrees(atan2(along[1], along[0])) + 90.0) % 180.0 - 90.0
    return f"{away_m:.3f} m, {round(left_deg, 1) + 0.0:g} deg"


def _runs_text(runs: Sequence[tuple[str, str]]) -> str:
    """Return the text of the first run, with the number of the others."""
    run, text = runs[0]
    if len(runs) == 1:
        return f"{run}: {text}"
    varied = "" if all(other == text for _, other in runs) else ", with other numbers,"
    return f"{run} and{varied} {plural(len(runs) - 1, 'more run')}: {text}"


def _suspicions(spec: RunSpec) -> Iterator[Suspicion]:
    """Yield what is suspicious about a run, and about the path of the built-in controller through its arena."""
    line = Arena.from_config(spec.arena).line
    yield from _in_radians(spec, line)
    yield from unusual_settings(spec)
    yield from shadows_without_robot(spec)
    yield from inside_walls(spec)
    yield from _outside_the_body(spec.robot)
    if spec.board is None and spec.controller is None:
        yield from _too_slow(spec.robot)
        if not line.pieces:
            yield Suspicion("arena.line", NO_LINE)
    if line.pieces and spec.board is None and spec.controller is None:
        yield from _starts_beside(spec, line)
        yield from _no_time_for_a_lap(spec, line)
        yield from _through_walls(spec, line)
        yield from too_close(spec, line)


def _outside_the_body(robot: RobotConfig) -> Iterator[Suspicion]:
    """Yield the range and line sensors that are farther from the middle of the axle than the body is long or wide."""
    chassis, mounts = robot.chassis, robot.tof.mounts
    sizes = {"x_m": chassis.length_m, "y_m": chassis.width_m}
    places = [
        ("robot.tof.mounts.front", mounts.front),
        ("robot.tof.mounts.left", mounts.left),
        ("robot.tof.mounts.right", mounts.right),
        ("robot.line_sensor", robot.line_sensor),
    ]
    for place, mount in places:
        for field, size_m in sizes.items():
            at_m = getattr(mount, field, 0.0)
            if abs(at_m) > size_m:
                where = "length" if field == "x_m" else "width"
                text = f"{place}.{field} {at_m:g} is far outside the body, whose {where} is {size_m:g} m"
                yield Suspicion(f"{place}.{field} outside", text)


def _path_speeds(controller: Controller) -> Iterator[tuple[str, float]]:
    """Yield the field and the speed [m/s] of each motion that follows no line or wall."""
    yield "avoidance.speed_m_s", controller.avoidance.speed_m_s
    if curves := controller.avoidance.curves:
        yield "avoidance.curves.face.speed_m_s", curves.face.speed_m_s
    yield "lost.speed_m_s", controller.lost.speed_m_s


def _too_slow(robot: RobotConfig) -> Iterator[Suspicion]:
    """Yield a speed that the control law asks of a wheel and that its motor does not reach even without load."""
    motor, half_track_m = MotorModel.from_config(robot.motor), 0.5 * robot.drive.track_m
    voltage_V = voltage_limit_V(robot.power)
    reached_m_s = 0.5 * robot.drive.wheel_diameter_m * motor.steady_state(voltage_V)[1]
    laws = {"line": robot.controller.line, "wall.gains": robot.controller.wall.gains}
    commanded = [
        (float(np.dot(follow(error, law), (1.0, half_track_m))), place, f" at an error of {error:g}")
        for place, law in laws.items()
        for error in (0.0, MAX_ERROR)
    ]
    commanded += [(speed_m_s, place, "") for place, speed_m_s in _path_speeds(robot.controller)]
    commanded_m_s, place, at_error = max(commanded)
    if commanded_m_s > reached_m_s:
        diameter_m = robot.drive.wheel_diameter_m
        larger = 2.0 * diameter_m
        radius = f"; if wheel_diameter_m is the radius, write {larger:g}" if commanded_m_s <= 2.0 * reached_m_s else ""
        text = (
            f"robot.controller.{place} asks a wheel for {commanded_m_s:.2g} m/s{at_error}, and the"
            f" motors reach {reached_m_s:.2g} m/s at {voltage_V:g} V with wheels of {diameter_m:g} m without load: the"
            f" robot is slower than that, and may cut bends{radius}"
        )
        yield Suspicion("speed beyond the motors", text)


def _starts_beside(spec: RunSpec, line: Line) -> Iterator[Suspicion]:
    away_m = float(_nearest(line, spec)[0])
    if away_m > BESIDE_M:
        text = f"the run starts {away_m:.2f} m away from the line, which its line sensor does not see there"
        yield Suspicion("start beside the line", text)


def _no_time_for_a_lap(spec: RunSpec, line: Line) -> Iterator[Suspicion]:
    """Yield a time limit that is too short for the length of the line at the largest speed of the controller."""
    settings, limit_s = spec.robot.controller, spec.stop.time_limit_s
    following = (settings.line.k1_m_s, settings.wall.gains.k1_m_s)
    fastest_m_s = max(*following, settings.avoidance.speed_m_s, settings.lost.speed_m_s)
    if spec.stop.lap and limit_s * fastest_m_s < line.length_m:
        text = (
            f"no lap can be finished within stop.time_limit_s, which is {limit_s:g}, and stop.lap makes the run fail"
            f" then: the {line.length_m:.2f} m of the line take {line.length_m / fastest_m_s:.1f} s at"
            f" {fastest_m_s:.2g} m/s, the largest speed of the controller; raise the limit, or set stop.lap=false"
        )
        yield Suspicion("no time for a lap", text)


def _through_walls(spec: RunSpec, line: Line) -> Iterator[Suspicion]:
    points = np.concatenate([piece.at(_along(piece.length_m)) for piece in line.pieces])
    for wall in spec.arena.walls:
        body = wall_footprint(wall)
        turn = np.array([[cos(body.yaw_rad), -sin(body.yaw_rad)], [sin(body.yaw_rad), cos(body.yaw_rad)]])
        inside = np.all(np.abs((points - body.center) @ turn) < 0.5 * np.array(body.size), axis=1)
        if inside.any():
            x, y = points[int(np.argmax(inside))]
            yield Suspicion(
                f"wall {wall.name}",
                f"the line leads through wall {wall.name} at x = {x:.2f}, y = {y:.2f} m, where the robot cannot follow "
                "it: move one of them, or leave out the wall (an arena that extends another keeps its walls, until it "
                "lists `walls` itself)",
            )


def run_warnings(spec: RunSpec, recording: Recording) -> tuple[str, ...]:
    """Return what is suspicious about a run; nothing for nearly all runs."""
    line = Arena.from_config(spec.arena).line
    setting_texts = [suspicion.text for suspicion in (*_in_radians(spec, line), *unusual_settings(spec))]
    units = commanded_in_other_units(spec, recording)
    return (*_standing(recording), *_without_the_line(spec, line, recording), *units, *setting_texts)


def _standing(recording: Recording) -> Iterator[str]:
    steps = np.diff(recording.trajectory.pose[:, :2], axis=0)
    if len(steps) and np.hypot(steps[:, 0], steps[:, 1]).sum() < MIN_PATH_M:
        yield "the robot moves less than 1 cm in this run: is it stuck, or are its motors too weak?"


def _without_the_line(spec: RunSpec, line: Line, recording: Recording) -> Iterator[str]:
    rows = int((recording.trajectory.state == State.LINE).sum())
    lost = int(recording["line_lost"].values[-1])
    if not line.pieces or lost <= MAX_LOST_SHARE * rows:
        return
    away_m = float(_nearest(line, spec)[0])
    cause = f": the run starts {away_m:.2f} m away from the line" if away_m > BESIDE_M else ""
    yield (
        f"the line sensor did not see the line in {100.0 * lost / rows:.0f} % of the time in which the controller"
        f" followed it{cause}"
    )


def _in_radians(spec: RunSpec, line: Line) -> Iterator[Suspicion]:
    """Yield the angles of the start and of settings whose numbers are probably radians."""
    yaw = spec.start.yaw_deg
    if line.pieces and 0.0 < abs(yaw) <= 2.0 * pi + 0.01:
        _, along = _nearest(line, spec)
        if _angle(along, radians(yaw)) > ACROSS_RAD and _angle(along, yaw) < ALONG_RAD:
            yield in_radians("yaw_deg", yaw, "as degrees, the start leads away from the line")
        elif "start.yaw_deg" not in spec.drawn and is_round_in_radians(yaw, "yaw_deg"):
            yield in_radians("yaw_deg", yaw)
    yield from settings_in_radians(spec)


def _nearest(line: Line, spec: RunSpec) -> tuple[float, Array]:
    """Return the distance [m] of the start from the centre line, and the unit vector along the line there."""
    start = np.array([spec.start.x_m, spec.start.y_m])
    distances: list[float] = []
    directions: list[Array] = []
    for piece in line.pieces:
        points = piece.at(_along(piece.length_m))
        steps = np.diff(points, axis=0)
        share = np.clip(((start - points[:-1]) * steps).sum(axis=1) / (steps**2).sum(axis=1), 0.0, 1.0)
        away = np.hypot(*(points[:-1] + share[:, None] * steps - start).T)
        nearest = int(np.argmin(away))
        distances.append(float(away[nearest]))
        directions.append(steps[nearest] / np.hypot(*steps[nearest]))
    best = int(np.argmin(distances))
    return distances[best], directions[best]


def _along(length_m: float) -> Array:
    """Return places [m] along a piece of line, with both of its ends."""
    return np.linspace(0.0, length_m, 2 + int(length_m / SPACING_M))


def _angle(along: Array, yaw_rad: float) -> float:
    """Return the angle [rad] between a heading and the line, which may be followed in both directions."""
    return float(np.arccos(min(1.0, abs(along[0] * cos(yaw_rad) + along[1] * sin(yaw_rad)))))
