"""Two JSON documents, leaf by leaf: the largest difference of their numbers, and the first of anything else."""

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
"""Keys by file that tell of the making, or follow from other files: no difference of the data."""

_MISSING = object()


def likeness(a: bytes, b: bytes, name: str) -> Likeness:
    ignored = HOW_IT_WAS_MADE.get(PurePosixPath(name).name, frozenset())
    try:
        leaves_a, leaves_b = (dict(_leaves(json.loads(data), ignored)) for data in (a, b))
    except (ValueError, RecursionError):
        return Likeness.none("is no JSON in A or in B")
    worst = Likeness(math.inf, "differs only in how it was made, or in its form")
    for path in dict.fromkeys((*leaves_a, *leaves_b)):
        one, other = leaves_a.get(path, _MISSING), leaves_b.get(path, _MISSING)
        if one == other and type(one) is type(other):
            continue
        told = f"{dotted(path)}: {_shown(one)} in A, {_shown(other)} in B"
        number, compared = _number(one), _number(other)
        if number is None or compared is None:
            return Likeness.none(told)
        found = level_db(np.array([number - compared]), abs(number))
        if found < worst.level_db:
            worst = Likeness(found, told)
    return worst


def _leaves(value: object, ignored: Collection[str], path: FieldPath = ()) -> Iterator[tuple[FieldPath, object]]:
    """Every scalar by its path; an empty list or mapping is a leaf of its own."""
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


def _shown(value: object) -> str:
    return "nothing" if value is _MISSING else shown(value)
