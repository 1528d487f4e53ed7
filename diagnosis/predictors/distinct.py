"""Robots that are equal for a stage, which then predicts them once.

Most robots of a fit differ in one number each, and most numbers act on one of several stages: the offset of a range
sensor moves no wheel. Later fits often begin where earlier ones ended.
"""

from collections.abc import Callable, Collection, Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from configs.effects.base import Slot
from configs.schema.base import Section
from configs.schema.robot import RobotConfig
from symolo.core.arrays import Array

MAX_BYTES = 256 * 2**20
"""Memory for the predictions of one stage that are kept. The search for rivals begins where the selection began, which
is several thousand predictions earlier."""

Key = tuple[object, ...]
"""All that acts on a stage, one value after the other."""
PLAIN = frozenset({float, int, str, bool, type(None)})
"""Types without values inside."""


def distinct(
    robots: Sequence[RobotConfig], parts: Collection[str], slots: Collection[Slot]
) -> tuple[list[RobotConfig], NDArray[np.int64]]:
    """Return the robots that differ in some of their parts, or in effects of some slots.

    Args:
        robots: At least one.
        parts: Of `RobotConfig`, that act on the stage.
        slots: Of the effects that do.

    Returns:
        One of each, and for every robot given which of those it is like, (M,).
    """
    numbers: dict[Key, int] = {}
    different: list[RobotConfig] = []
    which = []
    for robot in robots:
        key = _key(robot, parts, slots)
        if key not in numbers:
            numbers[key] = len(different)
            different.append(robot)
        which.append(numbers[key])
    return different, np.array(which)


class KnownPredictions:
    """Predictions of one stage, which are kept for robots that are equal for it.

    Args:
        parts: Of `RobotConfig`, that act on the stage.
        slots: Of the effects that do.
        predict: Function that returns the predictions (M, ...) of M robots, each independent of the others.
        max_bytes: Memory for the predictions that are kept; the oldest ones go first.
    """

    def __init__(
        self,
        parts: Collection[str],
        slots: Collection[Slot],
        predict: Callable[[Sequence[RobotConfig]], Array],
        max_bytes: int = MAX_BYTES,
    ) -> None:
        self._parts, self._slots, self._predict, self._max_bytes = parts, slots, predict, max_bytes
        self._known: dict[Key, Array] = {}

    def predictions(self, robots: Sequence[RobotConfig]) -> Array:
        """Return the predictions (M, ...) of M robots, at least one."""
        keys = [_key(robot, self._parts, self._slots) for robot in robots]
        new = {key: robot for key, robot in zip(keys, robots, strict=True) if key not in self._known}
        if new:
            # A view of one robot's prediction would keep the whole batch in memory after the others are forgotten.
            predictions = (prediction.copy() for prediction in self._predict(list(new.values())))
            self._known.update(zip(new, predictions, strict=True))
        predictions = np.stack([self._known[key] for key in keys])
        excess = len(self._known) - max(1, self._max_bytes // max(1, predictions[0].nbytes))
        for key in list(self._known)[: max(0, excess)]:
            del self._known[key]
        return predictions


def _key(robot: RobotConfig, parts: Collection[str], slots: Collection[Slot]) -> Key:
    key: list[object] = []
    _append([*(getattr(robot, part) for part in parts), *robot.effects.in_slots(slots)], key)
    return tuple(key)


def _append(nested: Iterable[object], key: list[object]) -> None:
    """Append nested values one by one, each section after its type."""
    for value in nested:
        # Nearly all values are numbers and texts, and there are millions.
        if type(value) in PLAIN:
            key.append(value)
        elif isinstance(value, Section):
            key.append(type(value))
            _append(vars(value).values(), key)
        elif isinstance(value, list | tuple):
            key.append(len(value))
            _append(value, key)
        elif isinstance(value, dict):
            _append([each for item in sorted(value.items()) for each in item], key)
        else:
            key.append(value)
