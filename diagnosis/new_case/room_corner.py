"""Places of a log whose origin is not the corner of the room."""

from collections.abc import Mapping

from diagnosis.measured.case_files.case_format import RANGE_SIDES
from logs.mapping import LogMapping
from symolo.core.errors import InputError


def from_corner(mapping: LogMapping, known: Mapping[str, float]) -> LogMapping:
    """Return the mapping with places counted from the corner of the room; the same if there is none or no range.

    Args:
        mapping: Columns of the log.
        known: Numbers that the user gave, by key.

    Raises:
        InputError: The mapping already has another offset.
    """
    columns = dict(mapping.columns)
    if not any(f"tof_{side}_m" in columns for side in RANGE_SIDES):
        return mapping
    for axis in ("x", "y"):
        key, name = f"room_corner_{axis}_m", f"{axis}_m"
        if key not in known or name not in columns:
            continue
        source, offset = columns[name], 0.0 - known[key]
        if source.offset not in {0.0, offset}:
            what = f"{key} and the offset of {name} in the mapping contradict each other"
            raise InputError(what, got=f"{known[key]:g} and {source.offset:g}", cure="leave out one of them")
        columns[name] = source.model_copy(update={"offset": offset})
    return mapping.model_copy(update={"columns": columns})
