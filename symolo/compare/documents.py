"""Comparison of two JSON documents, leaf by leaf: the values that differ, the least alike first."""

import json
import math
from collections.abc import Collection, Iterator
from pathlib import PurePosixPath

import numpy as np

from symolo.compare.likeness import Likeness, level_db
from symolo.core.errors import shown
from symolo.core.yaml.tree import FieldPath, dotted

HOW_IT_WAS_MADE = {
    "metadata.json": frozenset({"made_with"}),
    "frames.json": frozenset({"sha256", "cpu"}),
}
"""Keys by file that describe how the file was made, or follow from other files; they are no difference of the data."""

MAX_SHOWN = 5
"""Largest number of differences that are named."""

_MISSING = object()


def likeness(a: bytes, b: bytes, name: str) -> Likeness:
    ignored = HOW_IT_WAS_MADE.get(PurePosixPath(name).name, frozenset())
    try:
        leaves_a, leaves_b = (dict(_leaves(json.loads(data), ignored)) for data in (a, b))
    except (ValueError, RecursionError):
        return Likeness.none("is no JSON in A or in B")
    differences: list[tuple[float, str]] = []
    for path in dict.fromkeys((*leaves_a, *leaves_b)):
        one, other = leaves_a.get(path, _MISSING), leaves_b.get(path, _MISSING)
        if one != other or type(one) is not type(other):
            text_a, text_b = ("nothing" if value is _MISSING else shown(value) for value in (one, other))
            differences.append((_level_db(one, other), f"{dotted(path)}: {text_a} in A, {text_b} in B"))
    if not differences:
        return Likeness(math.inf, "differs only in how it was made, or in its form")
    differences.sort(key=lambda difference: difference[0])  # stable: equal levels stay in the order of the document
    texts = [text for _, text in differences[:MAX_SHOWN]]
    more = len(differences) - MAX_SHOWN
    return Likeness(differences[0][0], "; ".join([*texts, *([f"and {more} more"] if more > 0 else [])]))


def _level_db(one: object, other: object) -> float:
    """Return the level of two numbers; other values that differ are not alike."""
    number, other_number = _number(one), _number(other)
    if number is None or other_number is None:
        return -math.inf
    return level_db(np.array([number - other_number]), abs(number))


def _leaves(value: object, ignored: Collection[str], path: FieldPath = ()) -> Iterator[tuple[FieldPath, object]]:
    """Yield every scalar with its path; an empty list or mapping is a leaf too."""
    if isinstance(value, dict) and value:
        for key, item in value.items():
            if key not in ignored:
                yield from _leaves(item, ignored, (*path, key))
    elif isinstance(value, list) and value:
        for index, item in enumerate(value):
            yield from _leaves(item, ignored, (*path, index))
    elif isinstance(value, dict | list):
        yield path, "{}" if isinstance(value, dict) else "[]"
    else:
        yield path, value


def _number(value: object) -> float | None:
    if not isinstance(value, int | float) or isinstance(value, bool):
        return None
    try:
        number = float(value)
    except OverflowError:  # an integer of hundreds of digits
        return None
    return number if math.isfinite(number) else None
