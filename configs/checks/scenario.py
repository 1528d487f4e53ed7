"""Checks over several fields: impossible geometry, and settings that contradict each other."""

import math
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from configs.checks.arena import arena_faults
from configs.checks.cameras import camera_faults, image_faults, lens_faults
from configs.checks.generated_room import generated_room_faults
from configs.checks.look import look_faults
from configs.checks.motions import sized_name
from configs.checks.motor_strength import strength_faults
from configs.checks.robot import robot_faults
from configs.robot_sensors import SensorSettings
from configs.route_arenas import ARENA, ROUTES, arena_path
from configs.schema.appearance.look import LookConfig
from configs.schema.arena import ArenaConfig
from configs.schema.robot import RobotConfig
from configs.schema.scenario import Rates, Route, Scenario, SceneSpec
from configs.validation.faults import ConfigFault
from configs.validation.values import FieldDistribution
from symolo.arena.footprints import Rectangle, obstacle_footprint, overlap, wall_footprint
from symolo.core.distributions import Choice
from symolo.core.errors import InputError, together
from symolo.core.yaml.tree import FieldPath, Node, dotted, node_of
from symolo.dataset.documents.camera_specification import KIND as CAMERA
from symolo.dataset.splits import SplitMember, check


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
    path = arena_path(root, index)
    _refuse((fault.below(ARENA, path) for fault in _scenario_faults(scenario, [index])), root, note)


def check_splits(scenario: Scenario, root: Node) -> None:
    """Refuse a division that the planned runs do not allow. Arenas are known only when they are drawn.

    Raises:
        InputError: There are fewer groups than splits, or a run is not in exactly one split.
    """
    if scenario.splits is not None and scenario.splits.by != "arena":
        look, robot, seed = scenario.look.name, scenario.robot.name, scenario.seed
        runs = (f"{route.name}/test_{run}" for route in scenario.routes for run in range(1, route.runs + 1))
        members = [SplitMember(run, look, robot, seed) for run in runs]
        check(scenario.splits.rule(seed), members, root.place_of(("splits",)))


def check_distributions(distributions: Mapping[FieldPath, FieldDistribution], root: Node) -> None:
    """Refuse distributions whose ends are valid while nearly all draws are not."""
    for path, item in distributions.items():
        is_sensor = path[0] == "robot" and (len(path) == 3 or path[1] == "sensors")
        timing = is_sensor and path[-1] in {"period_s", "delay_s"}
        if timing and not isinstance(item.distribution, Choice):
            allowed = "a number or {choice: [...]}, because it is a whole number of physics steps"
            raise InputError(dotted(path), where=root.place_of(path), got=root.plain_at(path), allowed=allowed)


def check_arena(arena: ArenaConfig, root: Node) -> None:
    _refuse(arena_faults(arena), root)


def check_robot(robot: RobotConfig, root: Node) -> None:
    _refuse(robot_faults(robot, in_simulation=False), root)


def check_look(look: LookConfig, root: Node) -> None:
    _refuse(look_faults(look), root)


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
    yield from _arena_faults(scenario.arena, scenario.robot)
    yield from robot_faults(scenario.robot, in_simulation=True)
    yield from lens_faults(scenario)
    yield from camera_faults(scenario)
    yield from look_faults(scenario.look)
    yield from image_faults(scenario)
    yield from _period_faults(scenario.rates, scenario.robot)
    yield from strength_faults(scenario.rates, scenario.robot)
    if scenario.board is not None and scenario.controller is not None:
        allowed, cure = "none, since the board drives", "leave out board or controller"
        yield ConfigFault(("controller",), allowed=allowed, against=("board",), cure=cure)
    for index, route in zip(indices, scenario.routes, strict=True):
        yield from _start_faults(route.arena or scenario.arena, scenario.robot, route, (ROUTES, index, "start"))
        if route.arena is not None:
            for fault in _arena_faults(route.arena, scenario.robot):
                yield fault.below(ARENA, (ROUTES, index, ARENA))


def _arena_faults(arena: ArenaConfig, robot: RobotConfig) -> Iterator[ConfigFault]:
    yield from arena_faults(arena)
    yield from generated_room_faults(arena, robot)


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
            yield _blocked(route, path, sized_name(obstacle))


def _blocked(route: Route, path: FieldPath, name: str) -> ConfigFault:
    problem = f"the robot of route {route.name} would start inside {name}"
    return ConfigFault(
        path, problem, got=(route.start.x_m, route.start.y_m), cure="move the start or what stands there"
    )
