"""Draw first, build later: the only step that sees distributions. What it returns holds numbers alone."""

from collections.abc import Mapping

from configs.checks import check_run
from configs.errors import InputError, nearest
from configs.loader import ArenaAlone, LoadedScenario, LoadedSection, LookAlone, RobotAlone
from configs.schema.arena import ArenaConfig
from configs.schema.look import LookConfig
from configs.schema.robot import RobotConfig
from configs.schema.scenario import Render, RunSpec, Scenario
from configs.streams import stream
from configs.tree import FieldPath, Scalar, dotted
from configs.validation import Placed, validated


def draw_run(loaded: LoadedScenario, route: str, run: int) -> RunSpec:
    """The specification of one run.

    A value's stream is keyed by seed, route, run and its field path within the specification, so that neither
    other fields nor other runs nor the order in the file change it.

    Args:
        loaded: The checked scenario.
        route: Name of one of its routes.
        run: 1 to the number of runs of that route, or beyond it.

    Raises:
        InputError: When the drawn values make an impossible world, such as an obstacle on the start.
    """
    names = [item.name for item in loaded.routes]
    if route not in names:
        raise InputError("route", got=route, allowed=", ".join(names), nearest=nearest(route, names))
    start: FieldPath = ("routes", names.index(route), "start")
    values: dict[FieldPath, Scalar] = {}
    drawn: dict[str, Scalar] = {}
    for path, item in loaded.placed.items():
        own = ("start", *path[3:]) if path[:3] == start else path
        values[path] = item.ends()[0]
        if own[0] != "routes":
            values[path] = drawn[dotted(own)] = item.draw(stream(loaded.seed, route, run, dotted(own)))
    scenario = validated(loaded.root, Scenario, values)
    chosen = scenario.routes[names.index(route)]
    check_run(scenario, loaded.root, names.index(route), run)
    return RunSpec(
        scenario=scenario.name,
        seed=scenario.seed,
        route=route,
        run=run,
        start=chosen.start,
        stop=scenario.stop,
        rates=scenario.rates,
        render=scenario.render,
        arena=scenario.arena,
        robot=scenario.robot,
        look=scenario.look,
        drawn=dict(sorted(drawn.items())),  # type: ignore[arg-type]
    )


def draw_all(loaded: LoadedScenario) -> list[RunSpec]:
    """Every run of a scenario: routes in their order, runs from 1."""
    return [draw_run(loaded, route.name, run) for route in loaded.routes for run in range(1, route.runs + 1)]


def draw_arena(section: LoadedSection, seed: int, *key: str | int) -> tuple[ArenaConfig, dict[str, Scalar]]:
    """An arena alone, with its drawn values by path."""
    values = _draws(section.placed, seed, key)
    return validated(section.root, ArenaAlone, values).arena, _by_name(values)


def draw_robot(section: LoadedSection, seed: int, *key: str | int) -> tuple[RobotConfig, dict[str, Scalar]]:
    """A robot alone, with its drawn values by path."""
    values = _draws(section.placed, seed, key)
    return validated(section.root, RobotAlone, values).robot, _by_name(values)


def draw_look(section: LoadedSection, seed: int, *key: str | int) -> tuple[LookConfig, dict[str, Scalar]]:
    """A look alone, with its drawn values by path.

    With the scenario's seed and `(route, run)` as key, the values are those of the run itself.
    """
    values = _draws(section.placed, seed, key)
    return validated(section.root, LookAlone, values).look, _by_name(values)


def draw_render(loaded: LoadedScenario, seed: int, *key: str | int) -> Render:
    """The picture settings of a scenario alone.

    With the scenario's seed and `(route, run)` as key, the values are those of the run itself.
    """
    values: dict[FieldPath, Scalar] = {path: item.ends()[0] for path, item in loaded.placed.items()}
    values |= _draws({path: item for path, item in loaded.placed.items() if path[0] == "render"}, seed, key)
    return validated(loaded.root, Scenario, values).render


def _draws(placed: Mapping[FieldPath, Placed], seed: int, key: tuple[str | int, ...]) -> dict[FieldPath, Scalar]:
    return {path: item.draw(stream(seed, *key, dotted(path))) for path, item in placed.items()}


def _by_name(values: Mapping[FieldPath, Scalar]) -> dict[str, Scalar]:
    return {dotted(path): value for path, value in values.items()}
