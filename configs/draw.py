"""Random draws: the only step that sees distributions. Its results contain numbers only."""

import math
from collections.abc import Iterator, Mapping

import numpy as np

from configs.arena_generation.generate import NoArenaError, generate_arena
from configs.checks.scenario import check_run
from configs.loader import ArenaAlone, LoadedScenario, LoadedSection, LookAlone, RobotAlone, SingleRoute
from configs.posterior.drawing import HYPOTHESIS, NUMBERS, drawn_hypothesis, drawn_robot
from configs.posterior.schema import DrawnFrom, LoadedPosterior
from configs.route_arenas import arena_path
from configs.schema.appearance.look import LookConfig
from configs.schema.arena import ArenaConfig
from configs.schema.robot import RobotConfig
from configs.schema.scenario import Render, RunSpec, Scenario
from configs.validation.faults import ConfigFault
from configs.validation.values import FieldDistribution, validated
from symolo.core.errors import InputError, nearest
from symolo.core.geometry.poses import PlanarPose
from symolo.core.random_streams import stream
from symolo.core.yaml.tree import FieldPath, Node, Scalar, dotted

GENERATE = "arena.generate"
"""Key of the stream that a generated arena is drawn from."""

STREAM_NAMES = (
    {
        f"max_{name}": f"most_{name}"
        for name in (
            "bend_radius_m",
            "decoy_distance_m",
            "decoy_m",
            "decoys",
            "obstacle_m",
            "obstacle_offset_m",
            "obstacle_yaw_deg",
            "obstacles",
            "trim_m",
            "wall_clearance_m",
        )
    }
    | {
        f"min_{name}": f"least_{name}"
        for name in ("bend_radius_m", "decoy_m", "obstacle_m", "obstacles", "wall_clearance_m")
    }
    | {"effects": "terms"}
)
"""Parts of field paths that have another name in the keys of random streams, so that a seed gives the same numbers as
before version 0.2.0 renamed them."""


def draw_run(loaded: LoadedScenario, route: str, run: int) -> RunSpec:
    """Return the specification of one run.

    The random stream of a value is keyed by seed, route, run and its field path within the specification, so that
    neither other fields nor other runs nor the order in the file change it.

    Args:
        loaded: The checked scenario.
        route: Name of one of its routes.
        run: Number of the run, from 1; it may exceed the number of runs of the route.

    Raises:
        InputError: The drawn values are impossible together, such as an obstacle on the start.
    """
    if route not in loaded.single_routes:
        names = list(loaded.single_routes)
        raise InputError("route", got=route, allowed=", ".join(names), nearest=nearest(route, names))
    single = loaded.single_routes[route]
    values: dict[FieldPath, Scalar] = {}
    drawn: dict[str, Scalar] = {}
    for path, item in single.distributions.items():
        # A specification has the start of its route at the top.
        spec_path = path[2:] if path[0] == "routes" else path
        values[path] = drawn[dotted(spec_path)] = item.draw(_field_stream(spec_path, loaded.seed, route, run))
    root, like = single.root, None
    if loaded.like is not None:
        root, names, like = _like(loaded.like, root, values, (loaded.seed, route, run))
        drawn |= names
    scenario = validated(root, Scenario, values)
    if scenario.arena.generate is not None:
        arena = _arena_of_run(scenario.arena, loaded, single, values, (route, run))
        scenario = scenario.model_copy(update={"arena": arena})
    check_run(scenario, loaded.root, single.index, run)
    return RunSpec(
        scenario=scenario.name,
        seed=scenario.seed,
        route=route,
        run=run,
        start=scenario.routes[0].start,
        stop=scenario.stop,
        rates=scenario.rates,
        render=scenario.render,
        arena=scenario.arena,
        robot=scenario.robot,
        board=scenario.board,
        controller=scenario.controller,
        look=scenario.look,
        drawn=dict(sorted(drawn.items())),  # type: ignore[arg-type]
        like=like,
    )


def _like(
    posterior: LoadedPosterior, root: Node, values: Mapping[FieldPath, Scalar], key: tuple[int, str, int]
) -> tuple[Node, dict[str, Scalar], DrawnFrom]:
    """Return the tree with a robot from the posterior, the drawn values by name, and their origin."""
    hypothesis = drawn_hypothesis(posterior, stream(*key, HYPOTHESIS))
    robot = drawn_robot(root, hypothesis, values, stream(*key, NUMBERS))
    names: dict[str, Scalar] = {HYPOTHESIS: hypothesis.name}
    names |= {f"robot.{field}": value for field, value in robot.numbers.items()}
    measured = tuple(each for each in posterior.measured if each.quantity is not None)
    origin = DrawnFrom(sha256=posterior.sha256, hypothesis=hypothesis.name, measured=measured)
    return robot.on(root), names, origin


def _arena_of_run(
    arena: ArenaConfig,
    loaded: LoadedScenario,
    single: SingleRoute,
    values: Mapping[FieldPath, Scalar],
    key: tuple[str, int],
) -> ArenaConfig:
    """Return the generated arena of a run, whose line passes through the middle of the distribution of the start."""
    middle = _drawn_about(single, values).routes[0].start
    start = (middle.x_m, middle.y_m, math.radians(middle.yaw_deg))
    path, note = arena_path(loaded.root, single.index), f"drawn for {key[0]} run {key[1]}"
    return _generated(arena, start, stream(loaded.seed, *key, GENERATE), loaded.root, note=note, path=path)


def draw_all(loaded: LoadedScenario) -> list[RunSpec]:
    """Return all runs of a scenario: routes in their order, runs from 1."""
    return list(draw_each(loaded))


def draw_each(loaded: LoadedScenario) -> Iterator[RunSpec]:
    """Yield all runs of a scenario, each drawn when it is needed."""
    for route in loaded.routes:
        for run in range(1, route.runs + 1):
            yield draw_run(loaded, route.name, run)


def draw_arena(
    section: LoadedSection, seed: int, *key: str | int, start: PlanarPose = (0.0, 0.0, 0.0)
) -> tuple[ArenaConfig, dict[str, Scalar]]:
    """Return an arena with its drawn values by path; a generated line is straight at the start."""
    values = _draws(section.distributions, seed, key)
    arena = validated(section.root, ArenaAlone, values).arena
    return _generated(arena, start, stream(seed, *key, GENERATE), section.root), _by_name(values)


def draw_robot(section: LoadedSection, seed: int, *key: str | int) -> tuple[RobotConfig, dict[str, Scalar]]:
    """Return a robot with its drawn values by path."""
    values = _draws(section.distributions, seed, key)
    return validated(section.root, RobotAlone, values).robot, _by_name(values)


def draw_look(section: LoadedSection, seed: int, *key: str | int) -> tuple[LookConfig, dict[str, Scalar]]:
    """Return a look with its drawn values by path.

    With the scenario's seed and `(route, run)` as key, the values are those of the run itself.
    """
    values = _draws(section.distributions, seed, key)
    return validated(section.root, LookAlone, values).look, _by_name(values)


def draw_render(loaded: LoadedScenario, seed: int, *key: str | int) -> Render:
    """Return the image settings of a scenario.

    With the scenario's seed and `(route, run)` as key, the values are those of the run itself.
    """
    values: dict[FieldPath, Scalar] = {path: item.ends()[0] for path, item in loaded.distributions.items()}
    values |= _draws({path: item for path, item in loaded.distributions.items() if path[0] == "render"}, seed, key)
    return validated(loaded.root, Scenario, values).render


def _drawn_about(single: SingleRoute, values: Mapping[FieldPath, Scalar]) -> Scenario:
    """Return the scenario with the start in the middle of its distributions.

    A generated line passes there, so that the drawn start is as far off the line as its distribution says.
    """
    middle: dict[FieldPath, Scalar] = {}
    for path, item in single.distributions.items():
        low, *_, high = (*item.ends(), item.ends()[-1])
        if path[0] == "routes" and not item.has_options and isinstance(low, float) and isinstance(high, float):
            middle[path] = 0.5 * (low + high)
    return validated(single.root, Scenario, {**values, **middle})


def _generated(
    arena: ArenaConfig,
    start: PlanarPose,
    rng: np.random.Generator,
    root: Node,
    *,
    note: str = "",
    path: FieldPath = ("arena",),
) -> ArenaConfig:
    try:
        return generate_arena(arena, start, rng)
    except NoArenaError as error:
        cure = "set fewer corners or obstacles, smaller bends, a different radius_m or a larger floor"
        raise ConfigFault((*path, "generate"), str(error), cure=cure).error(root, note) from None


def _draws(
    distributions: Mapping[FieldPath, FieldDistribution], seed: int, key: tuple[str | int, ...]
) -> dict[FieldPath, Scalar]:
    return {path: item.draw(_field_stream(path, seed, *key)) for path, item in distributions.items()}


def _field_stream(path: FieldPath, seed: int, *key: str | int) -> np.random.Generator:
    """Return the random stream of the field at this path, for one seed and run."""
    return stream(seed, *key, dotted(tuple(STREAM_NAMES.get(str(part), part) for part in path)))


def _by_name(values: Mapping[FieldPath, Scalar]) -> dict[str, Scalar]:
    return {dotted(path): value for path, value in values.items()}
