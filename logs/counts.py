"""Counts of encoders as logs have them: running on, wrapping at the end of a counter, or from zero in each row."""

import numpy as np

from logs.columns.drive import COUNTED
from logs.mapping import MAPPING, Source
from logs.times import usual_step
from symolo.core.arrays import Array

COUNTERS = tuple(2.0**bits for bits in (8, 10, 12, 13, 14, 15, 16, 24, 32))
"""Numbers at which counters and absolute encoders wrap."""
SMOOTHED_ROWS = 10
"""Rows over which counts are averaged before they are compared with a speed, since single rows are rounded."""
FOLLOWS, CLEARLY = 0.5, 0.2
"""Least correlation of counts per row with the speed, and how much larger than that of running counts it must be."""
TYPICAL = 0.99
"""Share of the steps of a counter that are typical; a step across the wrap must not be MAX_STEPS times as large."""
MAX_STEPS = 3.0
JUMP, JUMP_TICKS = 20.0, 100.0
"""Steps of a counter that stand out: so many times a typical one, and at least so many counts."""
MOVING = 0.9
"""Share of the steps of a turning wheel that are no jumps: one that jumps more often has no steps so much smaller."""


def running_counts(numbers: Array, source: Source, name: str, notes: list[str]) -> Array:
    """Return the numbers of a column; those of an encoder as running counts, whatever form its log gives them.

    Args:
        numbers: (N,), as the log has them, NaN where one is missing.
        source: Entry of the mapping for the column.
        name: Name of the quantity.
        notes: List to which a sentence is added for each change.
    """
    if name not in COUNTED:
        return numbers
    if source.per_row:
        return running(numbers)
    counts, wraps_at = unwrapped(numbers, source.wraps_at)
    if wraps_at:
        notes.append(f"{source.column} wraps at {wraps_at:.0f} and is continued beyond it")
    return counts


def running(per_row: Array) -> Array:
    """Return running counts (N,) from counts since the row before; a missing one is interpolated, and its row is NaN.

    Args:
        per_row: (N,), NaN where a count is missing.
    """
    known = np.isfinite(per_row)
    if not known.any():
        return per_row
    number = np.arange(len(per_row))
    whole = np.interp(number, number[known], per_row[known])
    return np.where(known, np.cumsum(whole), np.nan)


def unwrapped(counts: Array, wraps_at: float = 0.0) -> tuple[Array, float]:
    """Return counts (N,) that run on beyond the end of their counter, and the number at which it wraps; 0 if it never
    did.

    Args:
        counts: (N,), NaN where a count is missing.
        wraps_at: The number, if it is known; it is recognised among COUNTERS by default.
    """
    known = np.isfinite(counts)
    values = counts[known]
    if len(values) < 2:
        return counts, 0.0
    steps = np.diff(values)
    span = float(np.ptp(values))
    for period in (wraps_at,) if wraps_at else COUNTERS:
        if period <= span:
            continue
        # Steps of more than half a period are shorter the other way round.
        whole = steps - period * np.rint(steps / period)
        across = np.abs(steps) > 0.5 * period
        if not across.any():
            break
        typical = max(float(np.quantile(np.abs(whole[~across]), TYPICAL)), 1.0) if (~across).any() else np.inf
        if wraps_at or float(np.abs(whole[across]).max()) <= MAX_STEPS * typical:
            result = counts.copy()
            result[known] = values[0] + np.concatenate([[0.0], np.cumsum(whole)])
            return result, period
    return counts, 0.0


def jump_note(column: str, counts: Array, t_s: Array, how: str = f"in {MAPPING}") -> str:
    """Return a sentence if running counts of a column jump; else an empty string.

    Args:
        column: Name of the column for the sentence.
        counts: (N,), NaN where one is missing.
        t_s: (N,), times of the rows.
        how: Words for where the user states the number at which a counter begins again.
    """
    far = jump(counts, t_s)
    if not far:
        return ""
    return (
        f"{column}: it jumps by {far:.0f} from one row to the next; if its counter begins again there, give wraps_at "
        f"{how}"
    )


def jump(counts: Array, t_s: Array) -> float:
    """Return the largest step between two rows of running counts, if it stands out; else 0.

    Args:
        counts: (N,), NaN where one is missing.
        t_s: (N,), times of the rows; over a gap of time, a wheel turns farther.
    """
    known = np.isfinite(counts) & np.isfinite(t_s)
    steps, steps_s = np.diff(counts[known]), np.diff(t_s[known])
    steps, steps_s = steps[steps_s > 0.0], steps_s[steps_s > 0.0]
    if not len(steps):
        return 0.0
    sizes = np.abs(steps) / np.maximum(steps_s / usual_step(steps_s), 1.0)
    largest = int(np.argmax(sizes))
    typical = float(np.quantile(sizes[sizes > 0.0], MOVING)) if sizes.any() else 0.0
    return float(steps[largest]) if sizes[largest] > max(JUMP * typical, JUMP_TICKS) else 0.0


def are_per_row(counts: Array, speed: Array) -> bool:
    """Return whether counts are those since the row before, since they themselves follow a speed.

    Args:
        counts: (N,), counts of a wheel.
        speed: (N,), anything that grows with its speed, such as its voltage or the distance since the row before.
    """
    change = np.diff(counts, prepend=counts[:1])
    # Where a counter wraps, its change is no speed.
    change = np.clip(change, *np.nanquantile(change, [1.0 - TYPICAL, TYPICAL])) if np.isfinite(change).any() else change
    by_value, by_change = (_correlation(_smooth(each), _smooth(speed)) for each in (counts, change))
    return by_value > FOLLOWS and by_value > by_change + CLEARLY


def _smooth(values: Array) -> Array:
    known = np.nan_to_num(values)
    rows = min(SMOOTHED_ROWS, len(known))
    return np.convolve(known, np.full(rows, 1.0 / rows), mode="valid")


def _correlation(x: Array, y: Array) -> float:
    x, y = x - x.mean(), y - y.mean()
    size = float(np.sqrt((x @ x) * (y @ y)))
    return abs(float(x @ y)) / size if size > 0.0 else 0.0
