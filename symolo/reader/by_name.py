"""Parts of a run by name, whose error for a wrong name lists those that there are."""

from collections.abc import Mapping
from typing import TypeVar

from symolo.core.errors import nearest

Part = TypeVar("Part")


class ByName(dict[str, Part]):
    """A dictionary of sensors or cameras by name."""

    def __init__(self, kind: str, run: str, parts: Mapping[str, Part]) -> None:
        """Collect the parts of a kind, such as `camera`, of a run."""
        super().__init__(parts)
        self._kind, self._run = kind, run

    def __missing__(self, name: str) -> Part:
        """Refuse a wrong name.

        Raises:
            KeyError: Always; its text lists the names.
        """
        close = nearest(name, self)
        hint = f"; did you mean {close}" if close else ""
        raise KeyError(f"{self._run} has no {self._kind} {name!r}; allowed: {', '.join(self) or 'none'}{hint}")
