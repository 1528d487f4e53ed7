"""What a new sampling does to the columns of a log, in words."""

from collections.abc import Collection

import numpy as np

from diagnosis.measured.case_files.case_format import RANGES
from symolo.core.arrays import Array

SAME_TIME = 1e-3
"""Difference of two times, as a share of a step, up to which a row counts as being at the time of a sample."""


def is_input(name: str) -> bool:
    """Return whether a column is a command or a voltage, which a sample has the mean of."""
    return name.endswith("_V") or "_cmd_" in name


def in_words(names: Collection[str], *, has_all_times: bool) -> str:
    """Return how columns are sampled again, as in `voltages are means, ranges are the nearest`.

    Args:
        names: The columns that have values.
        has_all_times: Whether the log has a row at the time of each sample, so that nothing is interpolated.
    """
    others = [name for name in names if name not in RANGES and not is_input(name)]
    counts = any(name.endswith("_ticks") for name in others)
    poses = any(not name.endswith("_ticks") for name in others)
    kinds = {"counts and poses": counts and poses, "counts": counts, "poses": poses}
    kind = next((words for words, is_there in kinds.items() if is_there), "")
    parts = ["voltages are means"] if any(map(is_input, names)) else []
    if kind:
        parts.append(f"{kind} are {'those of the row at that time' if has_all_times else 'interpolated'}")
    if not RANGES.isdisjoint(names):
        parts.append("ranges are the nearest")
    return ", ".join(parts)


def has_times(t_s: Array, wanted_s: float) -> bool:
    """Return whether times (n,) of two rows or more contain each multiple of a step after the first [s]."""
    since_s = t_s - t_s[0]
    samples_s = wanted_s * np.arange(int(np.floor(since_s[-1] / wanted_s + 1e-9)) + 1)
    after = np.clip(np.searchsorted(since_s, samples_s), 1, len(since_s) - 1)
    off_s = np.minimum(np.abs(since_s[after] - samples_s), np.abs(samples_s - since_s[after - 1]))
    return bool(np.all(off_s <= SAME_TIME * wanted_s))
