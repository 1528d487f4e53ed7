"""Checks over several fields: impossible geometry, and settings that contradict each other."""

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any

from configs.camera_checks import camera_faults, image_faults, lens_faults
from configs.faults import ConfigFault
from configs.motion_checks import motion_faults
from configs.robot_sensors import SensorSettings
from configs.schema.appearance.look import LookConfig
from configs.schema.arena import ArcPiece, ArenaConfig, StraightPiece
from configs.schema.base import Section
from configs.schema.robot import RobotConfig
from configs.schema.scenario import Rates, Route, Scenario, SceneSpec
from configs.validation import Placed
from symolo.arena.footprints import Point, Rectangle, obstacle_footprint, overlap, wall_footprint
from symolo.core.distributions import Choice
from symolo.core.errors import InputError, together
from symolo.core.yaml.tree import FieldPath, Node, dotted, node_of
from symolo.dataset.documents.camera_specification import KIND as CAMERA
from symolo.dataset.splits import SplitMember, check

FAR = 3.0
"""A point farther than so many half sides of the floor is probably given in another unit."""
LINTEL_M = 0.1
"""Smallest height of wall between a window and the ceiling; a window that is too high is made lower."""
MIN_WINDOW_M = 0.2


def check_scenario(scenario: Scenario, root: Node) -> None:
    """Refuse a scenario whose fields contradict each other.

    Raises:
        InputError: For each contradiction, at the place of one of its fields.
    """
    _refuse(_scenario_faults(scenario, range(len(scenario.routes))), root)


def check_run(scenario: Scenario, root: Node, index: int, run: int) -> None:
    """Refuse contradictions in the values that were drawn for one run.

    Args:
        scenario: The scenario with the route of the run alone.
        root: Tree of the whole scenario.
        index: Place of the route in that tree.
        run: Number of the run.
    """
    note = f"drawn for {scenario.routes[0].name} run {run}; narrow the distributions or take another seed"
    _refuse(_scenario_faults(scenario, [index]), root, note)


def check_splits(scenario: Scenario, root: Node) -> None:
    """Refuse a division that the planned runs do not allow.

    Raises:
        InputError: There are fewer groups than splits, or a run is not in exactly one split.
    """
    if scenario.splits is not None:
        look, robot, seed = scenario.look.name, scenario.robot.name, scenario.seed
        runs = (f"{route.name}/test_{run}" for route in scenario.routes for run in range(1, route.runs + 1))
        members = [SplitMember(run, look, robot, seed) for run in runs]
        check(scenario.splits.rule(seed), members, root.place_of(("splits",)))


def check_kinds(placed: Mapping[FieldPath, Placed], root: Node) -> None:
    """Refuse distributions whose ends are valid while nearly all draws are not."""
    for path, item in placed.items():
        of_sensor = path[0] == "robot" and (len(path) == 3 or path[1] == "sensors")
        timing = of_sensor and path[-1] in {"period_s", "delay_s"}
        if timing and not isinstance(item.distribution, Choice):
            allowed = "a number or {choice: [...]}, because it is a whole number of physics steps"
            raise InputError(dotted(path), where=root.place_of(path), got=root.plain_at(path), allowed=allowed)


def check_arena(arena: ArenaConfig, root: Node) -> None:
    _refuse(_arena_faults(arena), root)


def check_robot(robot: RobotConfig, root: Node) -> None:
    _refuse(robot_faults(robot, in_simulation=False), root)


def check_look(look: LookConfig, root: Node) -> None:
    _refuse(_look_faults(look), root)


def check_cameras(spec: SceneSpec) -> None:
    """Refuse a camera of a run that cannot take images.

    Raises:
        InputError: For each contradiction between its lens and the size and rendering of its images.
    """
    content = node_of(spec.model_dump(mode="json"), "")
    _refuse((*lens_faults(spec), *camera_faults(spec)), content)


def _refuse(faults: Iterable[ConfigFault], root: Node, note: str = "") -> None:
    errors = [fault.error(root, note) for fault in faults]
    if errors:
        raise together(errors)


def _scenario_faults(scenario: Scenario, indices: Iterable[int]) -> Iterator[ConfigFault]:
    """Yield the contradictions in a scenario whose routes have these places in the file."""
    yield from _route_name_faults(scenario.routes)
    yield from _arena_faults(scenario.arena)
    yield from robot_faults(scenario.robot, in_simulation=True)
    yield from lens_faults(scenario)
    yield from camera_faults(scenario)
    yield from _look_faults(scenario.look)
    yield from image_faults(scenario)
    yield from _period_faults(scenario.rates, scenario.robot)
    if scenario.board is not None and scenario.controller is not None:
        allowed, cure = "none, since the board drives", "leave out board or controller"
        yield ConfigFault(("controller",), allowed=allowed, against=("board",), cure=cure)
    for index, route in zip(indices, scenario.routes, strict=True):
        yield from _start_faults(scenario.arena, scenario.robot, route, ("routes", index, "start"))


def _route_name_faults(routes: tuple[Route, ...]) -> Iterator[ConfigFault]:
    seen: dict[str, int] = {}
    for index, route in enumerate(routes):
        first = seen.setdefault(route.name.lower(), index)
        if first != index:
            cure = "give each route another name, different in more than upper and lower case"
            yield ConfigFault(("routes", index, "name"), f"the same name as routes.{first}", got=route.name, cure=cure)


def _period_faults(rates: Rates, robot: RobotConfig) -> Iterator[ConfigFault]:
    # Images are rendered after the simulation, between its steps too.
    sampled = [(name, s) for name, s in robot.sensors if isinstance(s, SensorSettings) and s.kind != CAMERA]
    sensors: dict[FieldPath, Any] = {
        ("tof",): robot.tof,
        ("line_sensor",): robot.line_sensor,
        ("encoder",): robot.encoder,
        **{("sensors", name): sensor for name, sensor in sampled},
    }
    for place, sensor in sensors.items():
        for field, value_s, min_steps in (("period_s", sensor.period_s, 1), ("delay_s", sensor.delay_s, 0)):
            steps = value_s * rates.physics_hz
            if round(steps) < min_steps or not math.isclose(steps, round(steps), rel_tol=1e-9):
                near = max(min_steps, round(steps)) / rates.physics_hz
                step_s = 1 / rates.physics_hz
                allowed = f"a whole number of physics steps of {step_s:.9g} s (rates.physics_hz {rates.physics_hz})"
                yield ConfigFault(("robot", *place, field), got=value_s, allowed=allowed, cure=f"write {near:.9g}")


def _arena_faults(arena: ArenaConfig) -> Iterator[ConfigFault]:
    line: FieldPath = ("arena", "line", "pieces")
    for index, piece in enumerate(arena.line.pieces):
        yield from _piece_faults(piece, arena.line.width_m, (*line, index))
    names: dict[str, FieldPath] = {}
    for kind, items in (("walls", arena.walls), ("obstacles", arena.obstacles)):
        for index, item in enumerate(items):
            path: FieldPath = ("arena", kind, index)
            first = names.setdefault(item.name, path)
            if first != path:
                cure = "contacts and drawn values refer to names; give each another name"
                yield ConfigFault((*path, "name"), f"the same name as {dotted(first)}", got=item.name, cure=cure)
    for index, wall in enumerate(arena.walls):
        if math.dist(wall.start, wall.end) < 1e-3:
            yield ConfigFault(
                ("arena", "walls", index),
                "a wall of no length",
                got=wall.end,
                allowed="an end that differs from the start",
            )
    yield from _outside_faults(arena)
    yield from motion_faults(arena)
    yield from _generator_faults(arena)


def _generator_faults(arena: ArenaConfig) -> Iterator[ConfigFault]:
    placed: tuple[tuple[FieldPath, int], ...] = (
        (("arena", "line", "pieces"), len(arena.line.pieces)),
        (("arena", "walls"), len(arena.walls)),
        (("arena", "obstacles"), len(arena.obstacles)),
    )
    for path, count in placed:
        if arena.generate is not None and count:
            cure = f"write {dotted(path)}: [], or generate: null"
            problem = f"{count} of them beside arena.generate, which draws them"
            yield ConfigFault(path, problem, allowed="an empty list", against=("arena", "generate"), cure=cure)


def _piece_faults(piece: StraightPiece | ArcPiece, width_m: float, path: FieldPath) -> Iterator[ConfigFault]:
    if isinstance(piece, StraightPiece):
        if math.dist(piece.start, piece.end) < 1e-3:
            yield ConfigFault(
                path, "a straight piece of no length", got=piece.end, allowed="an end that differs from the start"
            )
        return
    sweep_deg = abs(piece.end_deg - piece.start_deg)
    if sweep_deg < 0.1:
        yield ConfigFault(path, "an arc of no length", got=piece.end_deg, allowed="end_deg other than start_deg")
    if sweep_deg > 360:
        yield ConfigFault(
            path, "the arc overlaps itself", got=sweep_deg, allowed="at most 360 from start_deg to end_deg"
        )
    if piece.radius_m <= width_m / 2:
        allowed = f"more than half the line's width of {width_m}"
        yield ConfigFault((*path, "radius_m"), got=piece.radius_m, allowed=allowed)


def _outside_faults(arena: ArenaConfig) -> Iterator[ConfigFault]:
    limit = arena.floor.half_extent_m
    points: list[tuple[FieldPath, Point]] = []
    for index, piece in enumerate(arena.line.pieces):
        path: FieldPath = ("arena", "line", "pieces", index)
        if isinstance(piece, StraightPiece):
            points += [((*path, "start"), piece.start), ((*path, "end"), piece.end)]
        else:
            points += [(path, point) for point in _outermost(piece)]
    for index, wall in enumerate(arena.walls):
        points += [(("arena", "walls", index, "start"), wall.start), (("arena", "walls", index, "end"), wall.end)]
    points += [(("arena", "obstacles", i, "center"), obstacle.center) for i, obstacle in enumerate(arena.obstacles)]
    for path, point in points:
        if (farthest := max(abs(point[0]), abs(point[1]))) > limit:
            allowed = f"points on the floor, within {limit} m of the origin along x and y"
            cure = "move it or enlarge arena.floor.half_extent_m"
            if farthest >= FAR * limit:
                cure = f"are the lengths of the arena in metres? If they are, {cure}"
            yield ConfigFault(path, "beyond the edge of the floor", got=point, allowed=allowed, cure=cure)


def _outermost(arc: ArcPiece) -> list[Point]:
    """Return points of an arc that include its extremes along x and y: the ends, and where it runs along an axis."""
    low, high = sorted((arc.start_deg, arc.end_deg))
    quarters = range(math.ceil(low / 90), math.floor(high / 90) + 1)
    directions = [math.radians(deg) for deg in (low, high, *(90 * quarter for quarter in quarters))]
    (x, y), r = arc.center, arc.radius_m
    return [(x + r * math.cos(direction), y + r * math.sin(direction)) for direction in directions]


def robot_faults(robot: RobotConfig, *, in_simulation: bool) -> Iterator[ConfigFault]:
    """Yield what is wrong with a robot in any arena.

    Args:
        robot: The robot.
        in_simulation: Whether PyBullet drives it, which cannot do all that a bench can measure.
    """
    yield from _body_faults(robot)
    yield from _range_faults(robot)
    yield from _stall_faults(robot)
    yield from _effect_faults(robot, in_simulation=in_simulation)
    yield from _sensor_faults(robot)
    corner: FieldPath = ("robot", "controller", "corner")
    yield from _order_faults(robot.controller.corner, corner, "front_below_m", "front_clear_m")


def _order_faults(section: Section, path: FieldPath, lower: str, upper: str) -> Iterator[ConfigFault]:
    """Yield a fault if one field of a section is not below another."""
    low, high = getattr(section, lower), getattr(section, upper)
    if low >= high:
        allowed = f"less than {upper}, which is {high}"
        yield ConfigFault((*path, lower), got=low, allowed=allowed, against=(*path, upper))


def _effect_faults(robot: RobotConfig, *, in_simulation: bool) -> Iterator[ConfigFault]:
    for effect in robot.effects:
        yield from _below(("robot", "effects", effect.name), effect.faults(in_simulation=in_simulation))


def _sensor_faults(robot: RobotConfig) -> Iterator[ConfigFault]:
    for name, settings in robot.sensors:
        if isinstance(settings, SensorSettings):
            yield from _below(("robot", "sensors", name), settings.faults())


def _below(place: FieldPath, faults: Iterable[ConfigFault]) -> Iterator[ConfigFault]:
    """Yield faults whose paths start at a place with their whole paths."""
    for fault in faults:
        against = (*place, *fault.against) if fault.against else ()
        yield replace(fault, path=(*place, *fault.path), against=against)


def _range_faults(robot: RobotConfig) -> Iterator[ConfigFault]:
    tof = robot.tof
    path: FieldPath = ("robot", "tof")
    yield from _order_faults(tof, path, "min_range_m", "max_range_m")
    if tof.min_range_m < tof.no_target_m < tof.max_range_m:
        ends = f"up to {tof.min_range_m} (min_range_m) or from {tof.max_range_m} (max_range_m)"
        yield ConfigFault(
            (*path, "no_target_m"), got=tof.no_target_m, allowed=f"values outside the valid range, {ends}"
        )


def _stall_faults(robot: RobotConfig) -> Iterator[ConfigFault]:
    motor = robot.motor
    voltage = min(robot.power.battery_voltage_V, robot.power.motor_voltage_limit_V)
    stall_N_m = motor.torque_constant_N_m_A * voltage / motor.winding_resistance_ohm
    if stall_N_m <= motor.coulomb_friction_N_m:
        path: FieldPath = ("robot", "motor")
        problem = "the motor cannot overcome its friction"
        allowed = f"less than {stall_N_m:.3g}, its torque at {voltage} V and {motor.winding_resistance_ohm} ohm"
        against = (*path, "winding_resistance_ohm")
        yield ConfigFault(
            (*path, "coulomb_friction_N_m"), problem, motor.coulomb_friction_N_m, allowed, against=against
        )


def _body_faults(robot: RobotConfig) -> Iterator[ConfigFault]:
    chassis, drive = robot.chassis, robot.drive
    chassis_path: FieldPath = ("robot", "chassis")
    drive_path: FieldPath = ("robot", "drive")
    max_track_m = chassis.width_m - drive.wheel_width_m
    if drive.track_m > max_track_m + 1e-9:
        allowed = f"at most {max_track_m:.6g}, chassis.width_m less drive.wheel_width_m, which covers the wheels"
        yield ConfigFault(
            (*drive_path, "track_m"), got=drive.track_m, allowed=allowed, against=(*chassis_path, "width_m")
        )
    if not chassis.clearance_m < drive.wheel_diameter_m <= chassis.length_m:
        allowed = f"more than chassis.clearance_m ({chassis.clearance_m}), up to chassis.length_m ({chassis.length_m})"
        yield ConfigFault((*drive_path, "wheel_diameter_m"), got=drive.wheel_diameter_m, allowed=allowed)
    yield from _order_faults(chassis, chassis_path, "clearance_m", "base_height_m")
    if abs(drive.caster_x_m) > chassis.length_m / 2:
        allowed = f"at most {chassis.length_m / 2:.6g}, half of chassis.length_m, before or behind the axle"
        against = (*chassis_path, "length_m")
        yield ConfigFault((*drive_path, "caster_x_m"), got=drive.caster_x_m, allowed=allowed, against=against)
    low, high = sorted((0.0, drive.caster_x_m))
    if not low <= chassis.center_of_mass_x_m <= high or low == high:
        allowed = f"between the axle at 0 and the caster at {drive.caster_x_m}, or the robot tips over"
        got, against = chassis.center_of_mass_x_m, (*drive_path, "caster_x_m")
        yield ConfigFault((*chassis_path, "center_of_mass_x_m"), got=got, allowed=allowed, against=against)


def _look_faults(look: LookConfig) -> Iterator[ConfigFault]:
    if look.floor.material == "image" and look.floor.image.file is None:
        cure = "name an image in the folder of look.assets, or choose another look.floor.material"
        yield ConfigFault(("look", "floor", "image", "file"), "missing, because the floor is an image", cure=cure)
    max_sill_m = look.room.height_m - LINTEL_M - MIN_WINDOW_M
    if look.window.sill_m > max_sill_m + 1e-9:
        problem = "the window does not fit below the ceiling"
        allowed = f"at most {max_sill_m:.6g}, room.height_m less {MIN_WINDOW_M} of window and {LINTEL_M} of wall"
        against: FieldPath = ("look", "room", "height_m")
        yield ConfigFault(("look", "window", "sill_m"), problem, look.window.sill_m, allowed, against=against)
    lamps = look.lamps.rows * look.lamps.flux_klm
    lamps += min(look.desk_lamps.count, look.room.furniture.tables) * look.desk_lamps.flux_klm
    if not (lamps or look.sun.illuminance_klx or look.sky.luminance_kcd_m2):
        allowed = "a value above 0 for lamps.rows and lamps.flux_klm, sun.illuminance_klx or sky.luminance_kcd_m2, "
        allowed += "or a desk lamp and a table for it"
        yield ConfigFault(("look", "lamps"), "there is no light", allowed=allowed)


def _start_faults(arena: ArenaConfig, robot: RobotConfig, route: Route, path: FieldPath) -> Iterator[ConfigFault]:
    start = route.start
    at = (start.x_m, start.y_m)
    body = Rectangle(at, (robot.chassis.length_m, robot.chassis.width_m), math.radians(start.yaw_deg))
    limit = arena.floor.half_extent_m
    if any(max(abs(x), abs(y)) > limit for x, y in body.corners()):
        allowed = f"poses on the floor, within {limit} m of the origin along x and y"
        yield ConfigFault(path, "the robot stands beyond the edge of the floor", got=at, allowed=allowed)
    for wall in arena.walls:
        if math.dist(wall.start, wall.end) > 0 and overlap(body, wall_footprint(wall)):
            yield _blocked(route, path, f"wall {wall.name}")
    for obstacle in arena.obstacles:
        if obstacle.solid and overlap(body, obstacle_footprint(obstacle)):
            yield _blocked(route, path, f"obstacle {obstacle.name}")


def _blocked(route: Route, path: FieldPath, name: str) -> ConfigFault:
    problem = f"the robot of route {route.name} would start inside {name}"
    return ConfigFault(
        path, problem, got=(route.start.x_m, route.start.y_m), cure="move the start or what stands there"
    )
