"""The settings of two releases that differ, from the scenarios in their metadata."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from symolo.core.distributions import in_words, parse
from symolo.core.errors import InputError, shown
from symolo.core.yaml.tree import FieldPath, Node, dotted, node_of
from symolo.dataset.documents.metadata import read_metadata

_NOTHING = "nothing"


@dataclass(frozen=True)
class ChangedSetting:
    """A field of the scenario whose value or distribution differs."""

    field: str
    """Path in the scenario, such as look.sun.elevation_deg."""
    a: str
    """Value or distribution in A; "nothing" without the field."""
    b: str
    """Value or distribution in B; "nothing" without the field."""

    def __str__(self) -> str:
        return f"other setting {self.field}: {self.a} in A, {self.b} in B"


def changed_settings(a: Path, b: Path) -> list[ChangedSetting]:
    """Return the fields of the scenarios of two releases that differ, in the order of A; none if one is no release."""
    metadata = [read_metadata(root) for root in (a, b)]
    fields = [dict(_fields(node_of(document.scenario, "metadata.json"), ())) for document in metadata if document]
    if len(fields) < 2:
        return []
    one, other = fields
    pairs = ((field, one.get(field, _NOTHING), other.get(field, _NOTHING)) for field in dict.fromkeys((*one, *other)))
    return [ChangedSetting(field, before, after) for field, before, after in pairs if before != after]


def _fields(node: Node, path: FieldPath) -> Iterator[tuple[str, str]]:
    """Yield the path of each value and of each distribution, with its text."""
    children = () if node.is_distribution else tuple(node.children())
    if not children:
        yield dotted(path), _in_words(node, path)
    for key, child in children:
        yield from _fields(child, (*path, key))


def _in_words(node: Node, path: FieldPath) -> str:
    if node.is_distribution:
        try:
            return in_words(parse(node, path))
        except InputError:  # written by another version
            pass
    return shown(node.plain())
