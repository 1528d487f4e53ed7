"""What differs from run to run because it was drawn: the values, beside the distribution that was asked for."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from symolo.core.distributions import Distribution, parse
from symolo.core.errors import InputError
from symolo.core.yaml_tree import FieldPath, Node, dotted, node_of
from symolo.report.statistics.run_facts import RunFacts

Value = float | int | str | bool

START = "start."
"""Path of what belongs to a route, of which each may ask for another distribution."""


@dataclass(frozen=True)
class Draw:
    field: str
    """Path within spec.json; with the route behind it where the distribution is the route's."""
    values: tuple[Value, ...]
    """Of the runs that have it, in their order."""
    asked: Distribution | None
    """None where the scenario tells nothing, as of what a generator of arenas drew."""

    @property
    def numbers(self) -> tuple[float, ...] | None:
        """None where some are names, or true and false."""
        if any(isinstance(value, bool | str) for value in self.values):
            return None
        return tuple(float(value) for value in self.values)

    @property
    def counts(self) -> list[tuple[str, int]]:
        """How often each value came, the most frequent first."""
        counted = Counter(str(value) for value in self.values)
        return sorted(counted.items(), key=lambda item: (-item[1], item[0]))


def draws_of(facts: Sequence[RunFacts], scenario: Mapping[str, Any]) -> tuple[Draw, ...]:
    """Everything that was drawn for any of the runs, by path.

    Args:
        facts: Of the runs.
        scenario: As metadata.json has it, with its distributions.
    """
    asked = dict(_asked(scenario))
    values: dict[tuple[str, str], list[Value]] = {}
    for one in facts:
        for field, value in one.drawn.items():
            route = one.route if field.startswith(START) else ""
            values.setdefault((field, route), []).append(value)
    return tuple(
        Draw(f"{field} ({route})" if route else field, tuple(of_runs), asked.get((field, route)))
        for (field, route), of_runs in sorted(values.items())
    )


def _asked(scenario: Mapping[str, Any]) -> Iterator[tuple[tuple[str, str], Distribution]]:
    """By field of spec.json, and the route where it is the route's."""
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
        except InputError:  # of another version: what was drawn is shown without it
            return
    else:
        for key, child in node.children():
            yield from _distributions(child, (*path, key))
