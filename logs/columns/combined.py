"""Columns that give one quantity together, by their names: quaternions, and times of seconds and parts of one."""

from collections.abc import Collection, Sequence

from logs.units.names import words_of

_SECONDS = frozenset(["sec", "secs", "second", "seconds"])
_PARTS = {
    "nanoseconds": frozenset(["nsec", "nsecs", "nanosec", "nanosecs", "nanosecond", "nanoseconds", "nanos"]),
    "microseconds": frozenset(["usec", "usecs", "microsec", "microsecs", "microsecond", "microseconds", "micros"]),
}
_STAMP_WORDS = frozenset(["header", "stamp", "stamps", "time", "timestamp", "msg", "message", "tv"])
_QUATERNION = frozenset(["q", "quat", "quaternion", "rotation", "rot", "orientation"])
_COMPONENTS = (*"xyzw", *"0123")


def stamp_columns(columns: Sequence[str], fillers: Collection[str]) -> dict[str, str]:
    """Return the columns of a time, such as `header.stamp.sec` and `.nanosec`, or `tv_sec` and `tv_usec`.

    Args:
        columns: Names of the columns.
        fillers: Words that may stand in a name.

    Returns:
        The names as a mapping has them: `column` of the seconds, and `nanoseconds` or `microseconds`; empty if one
        lacks.
    """
    seconds: dict[tuple[str, ...], str] = {}
    parts: dict[tuple[str, ...], tuple[str, str]] = {}
    for column in columns:
        *first, last = words_of(column) or ("",)
        if not set(first) <= _STAMP_WORDS | {*fillers}:
            continue
        if last in _SECONDS:
            seconds.setdefault(tuple(first), column)
        for unit in (unit for unit, names in _PARTS.items() if last in names):
            parts.setdefault(tuple(first), (unit, column))
    both = ((seconds[first], *parts[first]) for first in seconds if first in parts)
    return next(({"column": whole, unit: part} for whole, unit, part in both), {})


def quaternion_columns(columns: Sequence[str], fillers: Collection[str]) -> tuple[str, ...]:
    """Return the columns of a quaternion: x, y, z and w; or z and w of a turn about z; or q0 to q3, in any order.

    Args:
        columns: Names of the columns.
        fillers: Words that may stand in a name.
    """
    by_component: dict[str, str] = {}
    for column in columns:
        if component := _component(words_of(column), fillers):
            by_component.setdefault(component, column)
    for components in ("xyzw", "0123"):
        if all(component in by_component for component in components):
            return tuple(by_component[component] for component in components)
    has_turn = "z" in by_component and "w" in by_component and not {"x", "y"} & by_component.keys()
    return (by_component["z"], by_component["w"]) if has_turn else ()


def companions(columns: Sequence[str], fillers: Collection[str], used: Collection[str]) -> set[str]:
    """Return the columns that belong to a quaternion or a time of which one column is used."""
    groups = (stamp_columns(columns, fillers).values(), quaternion_columns(columns, fillers))
    return {column for group in groups if {*group} & {*used} for column in group}


def _component(words: Sequence[str], fillers: Collection[str]) -> str:
    """Return the component of a quaternion that a name states: x, y, z, w or 0 to 3; empty for another name."""
    rest = [word for word in words if word not in fillers or word in _QUATERNION]
    if len(rest) == 1 and rest[0][0] == "q":
        rest = ["q", rest[0][1:]]
    is_one = len(rest) >= 2 and {*rest[:-1]} <= _QUATERNION and rest[-1] in _COMPONENTS
    return rest[-1] if is_one else ""
