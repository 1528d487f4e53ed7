"""A fault of a configuration, told by its field path and the place where the field was written."""

from dataclasses import dataclass

from symolo.core.errors import InputError, shown
from symolo.core.yaml_tree import FieldPath, Node, dotted


@dataclass(frozen=True)
class ConfigFault:
    path: FieldPath
    problem: str = ""
    """What is wrong where the value alone does not tell."""
    got: object = ...
    """The value found; left out by default."""
    allowed: str = ""
    nearest: str = ""
    against: FieldPath = ()
    """The other field that it does not go with; its place is told too."""
    cure: str = ""

    def error(self, root: Node, note: str = "") -> InputError:
        """The fault as one line.

        Args:
            root: The tree that it was found in.
            note: Said at the end.
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
    """What to do about a faulty value that a distribution can take; empty where none stands at the path."""
    node = root.at(path)
    if node is None or not node.is_distribution:
        return ""
    cure = f"it is a value that {shown(node.plain())} can draw"
    normal = node.child("normal")
    if normal is not None and normal.child("low") is None:
        cure += ", which reaches 4 sd from the mean; limit it with {normal: {mean: m, sd: s, low: a, high: b}}"
    return cure
