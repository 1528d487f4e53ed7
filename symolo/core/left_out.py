"""Fields that a JSON text leaves out at their default, so that it has the bytes of versions without these fields."""

from collections.abc import Callable


def equals(default: object) -> Callable[[object], bool]:
    """Return the test of a field's value for its `exclude_if`."""
    return lambda value: value == default
