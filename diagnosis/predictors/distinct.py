"""Robots that a stage cannot tell apart are predicted once.

Most robots that a fit asks for differ in one number each, and most numbers act on one stage of several: a range
sensor's offset moves no wheel.
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
    """Robots that differ in some parts of theirs, or in effects of some slots.

    Args:
        robots: At least one.
        parts: Of `RobotConfig`, that act on the stage.
        slots: Of the effects that do.

    Returns:
        One of each, and for every robot given which of those it is like, (M,).
    """
    numbers: dict[tuple[object, ...], int] = {}
    found: list[RobotConfig] = []
    which = []
    for robot in robots:
        key = tuple(_values([*(getattr(robot, part) for part in parts), *robot.effects.in_slots(slots)]))
        if key not in numbers:
            numbers[key] = len(found)
            found.append(robot)
        which.append(numbers[key])
    return found, np.array(which)


def _values(of: Collection[object]) -> Iterator[object]:
    """Flat, with the kinds of sections before what they hold."""
    for value in of:
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
