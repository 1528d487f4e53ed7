"""Faults of a configuration, with the field path and the place where the field was written."""

from dataclasses import dataclass, replace
from pathlib import Path

from symolo.core.errors import InputError, shown
from symolo.core.yaml.reader import displayed
from symolo.core.yaml.tree import FieldPath, Node, dotted

SETTING = "--set "
"""Begin of the place of a value that the command line changes."""
_SHIPPED = Path(__file__).parents[1]


@dataclass(frozen=True)
class ConfigFault:
    """A fault of one field, before its place in the files is known."""

    path: FieldPath
    problem: str = ""
    """Description of the fault, if the value alone does not show it."""
    got: object = ...
    """Value at fault; not shown by default."""
    allowed: str = ""
    nearest: str = ""
    against: FieldPath = ()
    """Other field that it contradicts; its place is shown too."""
    cure: str = ""
    also: tuple[FieldPath, ...] = ()
    """Further fields that it may contradict; if the user changed one of them, its place is shown."""
    alternatives: tuple["ConfigFault", ...] = ()
    """The same contradiction at the other fields on which it depends; only one that the user changed is reported."""

    def below(self, section: str, path: FieldPath) -> "ConfigFault":
        """Return the same fault of a section that stands at another path of the tree."""

        def moved(field: FieldPath) -> FieldPath:
            return (*path, *field[1:]) if field[:1] == (section,) else field

        return replace(
            self,
            path=moved(self.path),
            against=moved(self.against),
            also=tuple(moved(field) for field in self.also),
            alternatives=tuple(each.below(section, path) for each in self.alternatives),
        )

    def _places(self, root: Node) -> tuple[str, str]:
        """Return the place of the fault, and a remark about the place of the other field.

        What the command line changes is at fault, rather than what it contradicts in a file.
        """
        here = root.place_of(self.path)
        changed = "" if here.startswith(SETTING) else _changed_below(root, self.path)
        if not self.against:
            return changed or here, ""
        against = max((self.against, *self.also), key=lambda path: _change(root.place_of(path)))
        there = root.place_of(against)
        if not changed and _change(there) > _change(here):
            return there, f" ({dotted(self.path)} is at {here})"
        return changed or here, f" ({dotted(against)} is at {there})"

    def error(self, root: Node, note: str = "") -> InputError:
        """Return the fault as an error of one line.

        Args:
            root: Tree with the fault.
            note: Text for the end of the line.
        """
        if self.alternatives:
            changed = max((self, *self.alternatives), key=lambda fault: _change(root.place_of(fault.path)))
            return replace(changed, alternatives=()).error(root, note)
        where, other = self._places(root)
        drawn = [_cure_of_distribution(path, root) for path in (self.path, self.against)]
        return InputError(
            ": ".join(part for part in (dotted(self.path) or "top level", self.problem) if part),
            where=where,
            got=self.got,
            allowed=self.allowed + other,
            nearest=self.nearest,
            cure="; ".join(part for part in (*drawn, self.cure, note) if part),
        )


def is_shipped(place: str) -> bool:
    """Return whether a place is in a file that symolo ships."""
    return place.startswith(f"{displayed(_SHIPPED)}/")


def _change(place: str) -> int:
    """Return 2 for a value from the command line, 1 for one from a file of the user, and 0 for a shipped one."""
    return 2 if place.startswith(SETTING) else int(not is_shipped(place))


def _changed_below(root: Node, path: FieldPath) -> str:
    """Return the place of the first value within a mapping that the command line changes; empty if there is none."""
    node = root.at(path)
    places = (inner.where for _, inner in node.walk()) if node else ()
    return next((place for place in places if place.startswith(SETTING)), "")


def _cure_of_distribution(path: FieldPath, root: Node) -> str:
    """Return what to do about a faulty value of a distribution; empty if there is no distribution at the path."""
    node = root.at(path)
    if node is None or not node.is_distribution:
        return ""
    cure = f"it is a value that {shown(node.plain())} can draw"
    normal = node.child("normal")
    if normal is not None and normal.child("low") is None:
        cure += ", which reaches 4 sd from the mean; limit it with {normal: {mean: m, sd: s, low: a, high: b}}"
    return cure
