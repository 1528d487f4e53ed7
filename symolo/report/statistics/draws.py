"""The fields that were drawn for each run: their values and their distribution in the scenario."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from symolo.core.distributions import Distribution, parse
from symolo.core.errors import InputError
from symolo.core.yaml.tree import FieldPath, Node, dotted, node_of
from symolo.report.statistics.run_facts import RunFacts

Value = float | int | str | bool

START, ARENA = "start.", "arena."
"""Beginnings of the paths of fields that a route may draw from distributions of its own."""


@dataclass(frozen=True)
class DrawnField:
    """A field of spec.json that has a distribution in the scenario."""

    field: str
    """Path within spec.json, followed by the route if the distribution belongs to a route."""
    values: tuple[Value, ...]
    """Values of the runs that have the field, in the order of the runs."""
    distribution: Distribution | None
    """Distribution in the scenario; None if it has none, as for what an arena generator drew."""

    @property
    def numbers(self) -> tuple[float, ...] | None:
        """The values as numbers; None if some are texts, true or false."""
        if any(isinstance(value, bool | str) for value in self.values):
            return None
        return tuple(float(value) for value in self.values)

    @property
    def counts(self) -> list[tuple[str, int]]:
        """Each value with the number of runs that have it, the most frequent first."""
        return sorted(Counter(map(str, self.values)).items(), key=lambda item: (-item[1], item[0]))


def drawn_fields(facts: Sequence[RunFacts], scenario: Mapping[str, Any]) -> tuple[DrawnField, ...]:
    """Return every field that was drawn for any of the runs, by path.

    Args:
        facts: The runs.
        scenario: The scenario of metadata.json, with its distributions.
    """
    distributions = dict(_by_field(scenario))
    with_arena = {route.get("name") for route in scenario.get("routes", ()) if route.get("arena")}
    values: dict[tuple[str, str], list[Value]] = {}
    for run in facts:
        for field, value in run.drawn.items():
            is_own = field.startswith(START) or (field.startswith(ARENA) and run.source_route in with_arena)
            route = run.source_route if is_own else ""
            values.setdefault((field, route), []).append(value)
    return tuple(
        DrawnField(f"{field} ({route})" if route else field, tuple(run_values), distributions.get((field, route)))
        for (field, route), run_values in sorted(values.items())
    )


def _by_field(scenario: Mapping[str, Any]) -> Iterator[tuple[tuple[str, str], Distribution]]:
    """Yield each distribution with the field of spec.json, and with the route if it belongs to one."""
    root = node_of(dict(scenario), "metadata.json")
    for path, distribution in _distributions(root, ()):
        if path[0] == "routes" and len(path) > 2:
            name = root.at((*path[:2], "name"))
            yield (dotted(path[2:]), str(name.value) if name else ""), distribution
        else:
            yield (dotted(path), ""), distribution


def _distributions(node: Node, path: FieldPath) -> Iterator[tuple[FieldPath, Distribution]]:
    if node.is_distribution:
        try:
            yield path, parse(node, path)
        except InputError:  # written by another version: its draws are shown without the distribution
            return
    else:
        for key, child in node.children():
            yield from _distributions(child, (*path, key))
