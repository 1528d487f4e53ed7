"""Robots that are equal for a stage, which then predicts them once.

Most robots of a fit differ in one number each, and most numbers act on one of several stages: the offset of a range
sensor moves no wheel.
"""

from collections.abc import Collection, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from configs.effects.base import Slot
from configs.schema.base import Section
from configs.schema.robot import RobotConfig


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
    numbers: dict[tuple[object, ...], int] = {}
    different: list[RobotConfig] = []
    which = []
    for robot in robots:
        key = tuple(_values([*(getattr(robot, part) for part in parts), *robot.effects.in_slots(slots)]))
        if key not in numbers:
            numbers[key] = len(different)
            different.append(robot)
        which.append(numbers[key])
    return different, np.array(which)


def _values(nested: Collection[object]) -> Iterator[object]:
    """Yield nested values one by one, each section after its type."""
    for value in nested:
        if isinstance(value, Section):
            yield type(value)
            yield from _values(vars(value).values())
        elif isinstance(value, list | tuple):
            yield len(value)
            yield from _values(value)
        elif isinstance(value, dict):
            yield from _values([each for item in sorted(value.items()) for each in item])
        else:
            yield value
