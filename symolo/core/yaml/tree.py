"""A configuration as a tree of values that remember where they were written."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

Scalar = str | int | float | bool | None
FieldPath = tuple[str | int, ...]
"""Keys and list indices from the top, for example `("arena", "walls", 0, "start")`."""

Values = Mapping[FieldPath, Scalar]
"""Values in the place of distributions, by path."""

DISTRIBUTION_KINDS = ("uniform", "normal", "log_uniform", "choice")


@dataclass(frozen=True)
class Node:
    """A value of a file together with the place where it was written."""

    value: "Scalar | dict[str, Node] | tuple[Node, ...]"
    where: str
    """`file:line`, or `--set field.path`."""
    complete_for: object = field(default=None, compare=False, repr=False)
    """What it is known to be complete for, at this node and below it, such as a shape by whose defaults it was."""

    @property
    def is_distribution(self) -> bool:
        """Whether this is a mapping meant as a distribution, well formed or not."""
        return isinstance(self.value, dict) and any(kind in self.value for kind in DISTRIBUTION_KINDS)

    def children(self) -> "Iterator[tuple[str | int, Node]]":
        if isinstance(self.value, dict):
            yield from self.value.items()
        elif isinstance(self.value, tuple):
            yield from enumerate(self.value)

    def child(self, key: str | int) -> "Node | None":
        if isinstance(self.value, dict):
            return self.value.get(key) if isinstance(key, str) else None
        if isinstance(self.value, tuple) and isinstance(key, int) and 0 <= key < len(self.value):
            return self.value[key]
        return None

    def at(self, path: FieldPath) -> "Node | None":
        node: Node | None = self
        for key in path:
            node = node.child(key) if node else None
        return node

    def plain(self) -> Any:  # noqa: ANN401 - whatever the file holds
        """Return the value without places: dict, list and scalars."""
        if isinstance(self.value, dict):
            return {key: child.plain() for key, child in self.value.items()}
        if isinstance(self.value, tuple):
            return [child.plain() for child in self.value]
        return self.value

    @cached_property
    def plain_for_reading(self) -> Any:  # noqa: ANN401 - whatever the file holds
        """`plain`, made once for all who do not change it."""
        if isinstance(self.value, dict):
            return {key: child.plain_for_reading for key, child in self.value.items()}
        if isinstance(self.value, tuple):
            return [child.plain_for_reading for child in self.value]
        return self.value

    def plain_at(self, path: FieldPath) -> Any:  # noqa: ANN401 - whatever the file holds
        node = self.at(path)
        return node.plain() if node else None

    def place_of(self, path: FieldPath) -> str:
        """Return the place in a file of the deepest node on the way to a path."""
        node = self
        for key in path:
            inner = node.child(key)
            if inner is None:
                break
            node = inner
        return node.where

    def walk(self, path: FieldPath = ()) -> "Iterator[tuple[FieldPath, Node]]":
        """Yield this node and every node below it, each with its path."""
        yield path, self
        for key, child in self.children():
            yield from child.walk((*path, key))


def dotted(path: FieldPath) -> str:
    return ".".join(str(part) for part in path)


def node_of(value: Any, where: str) -> Node:  # noqa: ANN401 - whatever JSON holds
    """Return a plain value as nodes that all have the same place."""
    if isinstance(value, dict):
        return Node({key: node_of(item, where) for key, item in value.items()}, where)
    if isinstance(value, list):
        return Node(tuple(node_of(item, where) for item in value), where)
    return Node(value, where)


_PAIRS = (("field_of_view_deg", "focal_length_mm"), ("rate_hz", "period_s"), ("course", "pieces"))
ALTERNATIVES = {one: other for pair in _PAIRS for one, other in (pair, pair[::-1])}
"""Pairs of fields of which a mapping has one: a field that is written replaces the other one of what it extends."""


def merge(base: Node, over: Node) -> Node:
    """Return `base` with `over` merged deeply; lists, scalars, distributions and mappings of another `kind` replace."""
    if not isinstance(base.value, dict) or not isinstance(over.value, dict):
        return over
    kinds = [kind.value for kind in (base.child("kind"), over.child("kind")) if kind]
    if base.is_distribution or over.is_distribution or kinds[:1] != kinds[-1:]:
        return over
    merged = {key: node for key, node in base.value.items() if ALTERNATIVES.get(key) not in over.value}
    for key, node in over.value.items():
        merged[key] = merge(merged[key], node) if key in merged else node
    return Node(merged, over.where)
