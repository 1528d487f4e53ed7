"""Poses a delay before the times of their rows."""

from collections.abc import Sequence

import numpy as np

from symolo.core.arrays import Array


def earlier(pose: Array, t_s: Array, trials: Sequence[int], delay_s: float | Array) -> Array:
    """Return poses (..., n, k) a delay before the times of their rows, interpolated between rows.

    Args:
        pose: Poses of all trials, or some of their components.
        t_s: (n,), times of the rows.
        trials: Number of rows of each trial; outside a trial its first or last pose is used.
        delay_s: One delay, or (M, 1), or one for each row, (n,) or (M, n).
    """
    if np.all(np.equal(delay_s, 0.0)):
        return pose
    delay_s = np.broadcast_to(delay_s, (*np.shape(delay_s)[:-1], len(t_s)))
    parts, begin = [], 0
    for rows in trials:
        part = slice(begin, begin + rows)
        times, poses = t_s[part], pose[..., part, :]
        begin += rows
        if rows < 2:
            parts.append(poses)
            continue
        # One delay gives times (n,) for all robots, M delays give (M, n); poses and times are broadcast to each other.
        delayed_s = np.clip(times - delay_s[..., part], times[0], times[-1])
        after = np.clip(np.searchsorted(times, delayed_s), 1, rows - 1)
        share = ((delayed_s - times[after - 1]) / (times[after] - times[after - 1]))[..., None]
        shape = np.broadcast_shapes(poses.shape[:-1], after.shape)
        poses, index = np.broadcast_to(poses, (*shape, poses.shape[-1])), np.broadcast_to(after, shape)[..., None]
        before, later = (np.take_along_axis(poses, place, axis=-2) for place in (index - 1, index))
        parts.append(before + share * (later - before))
    shape = max((part.shape[:-2] for part in parts), key=len)
    return np.concatenate([np.broadcast_to(part, (*shape, *part.shape[-2:])) for part in parts], axis=-2)
