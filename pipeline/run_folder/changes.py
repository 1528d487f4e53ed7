"""The fields of a run that changed, which is why something is made again."""

import re
from collections.abc import Iterator, Sequence
from itertools import islice

from configs.schema.scenario import SceneSpec
from pipeline.stages.simulate_runs import simulation_inputs
from symolo.core.errors import shown

MAX_CHANGES = 3
"""Largest number of fields that a message names; one cause often changes many."""

_TEXT = re.compile(r"robot\.(effect|sensor)_files\.\d+\.text")
"""Text of a file whose SHA-256 has changed as well, which says enough."""

_SHA256 = re.compile(r"[0-9a-f]{64}")

ABOUT = ("drawn", "scenario")
"""Fields on which no image depends: they say where the other values came from."""


def changes(made: SceneSpec, requested: SceneSpec, *, simulation: bool = False) -> list[str]:
    """Return the changed fields with their values before and now, such as `look.sun.elevation_deg 30.0 -> 60.0`.

    Args:
        made: Specification from which the files were made.
        requested: Specification from which they would be made now.
        simulation: Whether only what the trajectory depends on counts.
    """
    trees = [simulation_inputs(spec) if simulation else spec.model_dump(mode="json") for spec in (made, requested)]
    before, now = ({key: value for key, value in tree.items() if key not in ABOUT} for tree in trees)
    # Messages name the first changes only, and no image depends on a description.
    return sorted(_differences(before, now, ""), key=lambda text: text.partition(" ")[0].endswith("description"))


def first_changes(changed: Sequence[str]) -> str:
    """Return the first of these changes as a line."""
    more = f" and {len(changed) - MAX_CHANGES} more" if len(changed) > MAX_CHANGES else ""
    return ", ".join(islice(changed, MAX_CHANGES)) + more


def _differences(before: object, now: object, path: str) -> Iterator[str]:
    if isinstance(before, dict) and isinstance(now, dict):
        for key in dict.fromkeys((*before, *now)):
            yield from _differences(before.get(key), now.get(key), f"{path}.{key}" if path else str(key))
    elif isinstance(before, list) and isinstance(now, list) and len(before) == len(now):
        for i, (one, other) in enumerate(zip(before, now, strict=True)):
            yield from _differences(one, other, f"{path}.{i}")
    elif before != now and not _TEXT.fullmatch(path):
        yield f"{path} {_short(before)} -> {_short(now)}"


def _short(value: object) -> str:
    """Return a value for a line; the first digits of a SHA-256 say enough."""
    return value[:12] if isinstance(value, str) and _SHA256.fullmatch(value) else shown(value)
