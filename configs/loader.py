"""Loading of a scenario: from its name to a resolved and checked tree from which runs are drawn."""

from collections import ChainMap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Any

from configs.arena_shapes.line_course import with_course
from configs.arena_shapes.polygons import with_polygons
from configs.assets.folder import fields_with_files, with_assets
from configs.assets.meshes import with_meshes
from configs.checks.scenario import (
    check_arena,
    check_distributions,
    check_look,
    check_robot,
    check_scenario,
    check_splits,
)
from configs.overrides import apply_override, check_order, with_route_index
from configs.posterior.agreement import check_posterior, without_shipped_draws
from configs.posterior.reading import with_posterior
from configs.posterior.schema import LoadedPosterior
from configs.references import locate, read_file, resolve
from configs.robot_controller import with_chosen
from configs.route_arenas import ARENA, arena_path, check_arena_is_used, single_route_root, with_each_arena
from configs.schema.appearance.look import LookConfig
from configs.schema.arena import ArenaConfig
from configs.schema.base import Section
from configs.schema.robot import RobotConfig
from configs.schema.scenario import Rates, Scenario, Stop
from configs.user_files import with_user_files
from configs.validation.shapes import Shape, with_defaults
from configs.validation.values import (
    FieldDistribution,
    all_faults,
    distributions_of,
    probes,
    validated,
    with_independent,
)
from symolo.core.errors import InputError, apart, together
from symolo.core.yaml.reader import displayed
from symolo.core.yaml.tree import FieldPath, Node, dotted, node_of


@dataclass(frozen=True)
class PlannedRoute:
    """A route of a scenario, with its number of runs."""

    name: str
    runs: int


@dataclass(frozen=True)
class SingleRoute:
    """A scenario without its other routes, so that the cost of drawing a run does not grow with their number.

    Nothing in a run depends on the other routes, and every value that a field of a route can take was checked by itself
    when the scenario was loaded.
    """

    index: int
    """Place of the route in the whole scenario; here it is the first one."""
    root: Node
    """Tree with this route and its arena."""
    distributions: Mapping[FieldPath, FieldDistribution]
    """Distributions by field path; those of the route begin with `("routes", 0)`."""


@dataclass(frozen=True)
class LoadedScenario:
    """A scenario with files, names and overrides resolved, checked at every end of its distributions."""

    root: Node
    distributions: Mapping[FieldPath, FieldDistribution]
    """Distributions by field path."""
    assets: Mapping[str, Path]
    """Paths of the user's files that the look names, by SHA-256."""
    name: str
    description: str
    licence: str
    seed: int
    routes: tuple[PlannedRoute, ...]
    stop: Stop
    rates: Rates
    like: LoadedPosterior | None = None
    """Posterior from which the robots are drawn; None for none."""
    replaced_draws: tuple[str, ...] = ()
    """Fields that the shipped scenario draws, and that come from the posterior instead."""

    @cached_property
    def single_routes(self) -> Mapping[str, SingleRoute]:
        """The scenario with each of its routes alone, by the name of the route."""
        shared: dict[FieldPath, FieldDistribution] = {}
        by_route: list[dict[FieldPath, FieldDistribution]] = [{} for _ in self.routes]
        for path, item in self.distributions.items():
            match path:
                case "routes", int(index), "arena", *rest:
                    by_route[index][(ARENA, *rest)] = item
                case "routes", int(index), *rest:
                    by_route[index][("routes", 0, *rest)] = item
                case _:
                    shared[path] = item
        elsewhere = {path: item for path, item in shared.items() if path[0] != ARENA}
        singles: dict[str, SingleRoute] = {}
        routes = self.root.child("routes")
        assert routes is not None  # noqa: S101 - the schema demands it
        for index, (route, (_, node)) in enumerate(zip(self.routes, routes.children(), strict=True)):
            has_own = arena_path(self.root, index) != (ARENA,)
            distributions = ChainMap(by_route[index], elsewhere if has_own else shared)
            singles[route.name] = SingleRoute(index, single_route_root(self.root, node), distributions)
        return singles

    @property
    def tree(self) -> dict[str, Any]:
        """The whole scenario as plain values, with distributions as written."""
        return self.root.plain()

    @property
    def origins(self) -> dict[str, str]:
        """Field path -> `file:line` or `--set field.path`."""
        return _origins(self.root)


@dataclass(frozen=True)
class LoadedSection:
    """An arena, robot or look without a scenario; field paths begin with its kind, as in a scenario."""

    kind: str
    root: Node
    distributions: Mapping[FieldPath, FieldDistribution]
    assets: Mapping[str, Path]
    """Paths of the user's files that the look names, by SHA-256."""

    @property
    def tree(self) -> dict[str, Any]:
        return self.root.plain()[self.kind]

    @property
    def origins(self) -> dict[str, str]:
        return _origins(self.root)


class ArenaAlone(Section):
    """A document with nothing but an arena."""

    arena: ArenaConfig


class RobotAlone(Section):
    """A document with nothing but a robot."""

    robot: RobotConfig


class LookAlone(Section):
    """A document with nothing but a look."""

    look: LookConfig


NOMINAL_ROBOT = "nominal"
"""Name of the shipped robot that all others differ from."""
ALONE: Mapping[str, type[ArenaAlone | RobotAlone | LookAlone]] = MappingProxyType(
    {"arena": ArenaAlone, "robot": RobotAlone, "look": LookAlone}
)
_CHECKS: Mapping[str, Callable[[Any, Node], None]] = MappingProxyType(
    {"arena": check_arena, "robot": check_robot, "look": check_look}
)


def load_scenario(name_or_path: str, overrides: Sequence[str] = ()) -> LoadedScenario:
    """Load a shipped scenario by name, or any by path.

    Args:
        name_or_path: Name of a shipped scenario such as `smoke`, or path of a YAML file.
        overrides: Texts such as `look.sun.elevation_deg=30`, applied in this order.

    Raises:
        InputError: Something is wrong; nothing has been drawn yet.
    """
    failed: list[tuple[str, InputError]] = []
    path = locate("scenario", name_or_path, folder=Path(), what="scenario")
    root = read_file("scenario", path, failed=failed)
    if failed:
        raise together(_with_faults_elsewhere(root, failed))
    completed = _overridden(root, Scenario, overrides)
    check_arena_is_used(completed, displayed(path), overrides)
    root, replaced = without_shipped_draws(with_posterior(completed))
    root = with_chosen(root)
    if root is not completed:
        root = with_defaults(root, Shape.from_model(Scenario))
    root, assets = _with_files(_with_shapes(root), Scenario)
    return replace(_checked(root, assets), replaced_draws=replaced)


def _with_shapes(root: Node) -> Node:
    """Return a tree with the walls of polygons and the pieces of lines through points in all its arenas."""
    return with_each_arena(root, lambda tree: with_course(with_polygons(tree)))


def _with_faults_elsewhere(root: Node, failed: Sequence[tuple[str, InputError]]) -> list[InputError]:
    """Return the faults of sections that could not be loaded, and those of the rest of the scenario."""
    try:
        root = with_defaults(with_chosen(with_posterior(_completed(root, Scenario))), Shape.from_model(Scenario))
        others = all_faults(with_each_arena(_with_shapes(root), with_meshes), Scenario)
    except InputError as error:
        others = apart(error)
    sections = {section for section, _ in failed}
    # Files of the look are read once everything is loaded, so nobody knows which names of files are right.
    left_out = fields_with_files(Shape.from_model(Scenario)) if root.place_of(("look", "assets")) else frozenset()
    others = [one for one in others if one.field.partition(".")[0] not in sections and one.field not in left_out]
    return [*(fault for _, error in failed for fault in apart(error)), *others]


def _with_files(root: Node, model: type[Section]) -> tuple[Node, Mapping[str, Path]]:
    """Return a tree with the files that it names described by their content, and their paths by SHA-256.

    Raises:
        InputError: A file cannot be used; faults of fields that name no file are reported, too.
    """
    root = with_each_arena(root, with_meshes)
    try:
        return with_assets(root, Shape.from_model(model))
    except InputError as error:
        left_out = fields_with_files(Shape.from_model(model))
        others = [fault for fault in all_faults(root, model) if fault.field not in left_out]
        raise together(with_independent(apart(error), others)) from None


def load_resolved(tree: Mapping[str, Any], where: str) -> LoadedScenario:
    """Return the scenario with this `tree`, as metadata.json of a dataset contains it; no file is read.

    Raises:
        InputError: It does not fit this version; `where` is shown as the place of its fields.
    """
    return _checked(node_of(tree, where), {})


def _checked(root: Node, assets: Mapping[str, Path]) -> LoadedScenario:
    distributions = distributions_of(root, Scenario)
    check_distributions(distributions, root)
    probed = [validated(root, Scenario, values) for values in probes(distributions)]
    for scenario in probed:
        check_scenario(scenario, root)
    scenario = probed[0]  # the fields below are the same in all
    check_splits(scenario, root)
    if scenario.like is not None:
        check_posterior(root, scenario.like, next(probes(distributions)))
    return LoadedScenario(
        root=root,
        distributions=distributions,
        assets=assets,
        name=scenario.name,
        description=scenario.description,
        licence=scenario.licence,
        seed=scenario.seed,
        routes=tuple(PlannedRoute(route.name, route.runs) for route in scenario.routes),
        stop=scenario.stop,
        rates=scenario.rates,
        like=scenario.like,
    )


def load_section(kind: str, name_or_path: str, overrides: Sequence[str] = (), option: str = "") -> LoadedSection:
    """Load an arena, a robot or a look alone, for example to render a run again under another look.

    Args:
        kind: arena, robot or look.
        name_or_path: The name of a shipped file, or a path.
        overrides: Texts such as `look.sun.elevation_deg=30`.
        option: Origin of the name, for errors; `--<kind>` by default.
    """
    return _section(
        kind, read_file(kind, locate(kind, name_or_path, folder=Path(), what=option or f"--{kind}")), overrides
    )


@cache
def shipped_robot() -> RobotConfig:
    """Return the shipped robot `nominal`, which draws nothing and has no user's files.

    Its file needs none of what `load_section` does, of which the JSON Schema of all robots takes longest.
    """
    path = locate("robot", NOMINAL_ROBOT, folder=Path(), what="robot")
    return RobotConfig.model_validate(read_file("robot", path).plain())


def section_of(kind: str, settings: Mapping[str, Any], where: str, overrides: Sequence[str] = ()) -> LoadedSection:
    """Return an arena, a robot or a look with these settings, as if a file had them; `where` is its place in messages.

    Raises:
        InputError: A setting is wrong.
    """
    return _section(kind, resolve(kind, node_of(dict(settings), where), Path(), prefix=(kind,)), overrides)


def _section(kind: str, node: Node, overrides: Sequence[str] = ()) -> LoadedSection:
    model = ALONE[kind]
    root = _overridden(Node({kind: node}, node.where), model, overrides)
    root, assets = _with_files(_with_shapes(root), model)
    distributions = distributions_of(root, model)
    for values in probes(distributions):
        _CHECKS[kind](getattr(validated(root, model, values), kind), root)
    return LoadedSection(kind, root, distributions, assets)


def _overridden(root: Node, model: type[Section], overrides: Sequence[str]) -> Node:
    root = _completed(root, model)
    indexed: list[str] = []
    for text in overrides:
        indexed.append(with_route_index(root, text))
        # Add defaults again, because a new list item or section may lack fields.
        root = _completed(apply_override(root, text), model)
    check_order(overrides, indexed)
    return root


def _completed(root: Node, model: type[Section]) -> Node:
    """Return the tree with all defaults, after loading the files of the user that its robot names."""
    root = with_user_files(root)
    return with_defaults(root, Shape.from_model(model))


def _origins(root: Node) -> dict[str, str]:
    return {dotted(path): node.where for path, node in root.walk() if path}
