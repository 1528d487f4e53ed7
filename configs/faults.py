"""Faults of a configuration, with the field path and the place where the field was written."""

from dataclasses import dataclass

from symolo.core.errors import InputError, shown
from symolo.core.yaml.tree import FieldPath, Node, dotted


@dataclass(frozen=True)
class ConfigFault:
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

    def error(self, root: Node, note: str = "") -> InputError:
        """Return the fault as an error of one line.

        Args:
            root: Tree with the fault.
            note: Text for the end of the line.
        """
        other = f" (given at {root.place_of(self.against)})" if self.against else ""
        drawn = [_cure_of_distribution(path, root) for path in (self.path, self.against)]
        return InputError(
            ": ".join(part for part in (dotted(self.path) or "top level", self.problem) if part),
            where=root.place_of(self.path),
            got=self.got,
            allowed=self.allowed + other,
            nearest=self.nearest,
            cure="; ".join(part for part in (*drawn, self.cure, note) if part),
        )


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
