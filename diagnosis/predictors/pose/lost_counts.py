"""Counts that an encoder loses at one angle of its wheel, and how the changes of the pose respond to them.

A damaged slot of an encoder is missed once in each turn. The counted way is then too short by as much in each turn, as
with a larger wheel, but the loss comes at once. The first harmonic of such jumps resembles a wheel that runs
out of true, so that the two must compete. A wheel has turned further than it was counted, so that the angle of the
damage drifts in the counts.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from diagnosis.predictors.base import InputResponse
from symolo.core.arrays import Array

LOST = "lost counts"
"""What the responses are; with a negative size, the encoder adds counts."""
ANGLES = 16
"""Angles of the damage that are tried, evenly spread over a turn."""
LOST_PER_TURN = (0.0, 0.01, 0.025, 0.05)
"""Shares of a turn by which the angle may drift in each turn."""


def lost_counts(
    counted_turns: Array, windows: tuple[NDArray[np.int64], NDArray[np.int64]], track_m: float
) -> Iterator[tuple[InputResponse, ...]]:
    """Yield the responses of the distances forward and to the left and of the turn, for each damage.

    Args:
        counted_turns: (n, 2), turns of the right and the left wheel by their counts, in each row.
        windows: First and last row (m,) of each change of the pose.
        track_m: Distance between the wheels.
    """
    first, last = windows
    for wheel, (side, sign) in enumerate((("right", 1.0), ("left", -1.0))):
        for lost in LOST_PER_TURN:
            turns = counted_turns[:, wheel] * (1.0 + lost)
            for angle in (np.arange(ANGLES) / ANGLES).tolist():
                times = np.floor(turns - angle)
                passed = times[last] - times[first]
                by_component = (0.5 * passed, np.zeros_like(passed), sign * passed / track_m)
                where = f"wheel_angle_rad[{side}]"
                yield tuple(InputResponse(where, LOST, response, chosen=3) for response in by_component)
