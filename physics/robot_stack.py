"""Many robots as one configuration whose numbers are arrays, for one pass of numpy over all of them."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from configs.schema.base import Section
from configs.schema.robot import RobotConfig
from configs.schema.terms.table import Terms

UNPHYSICAL = frozenset({"name", "description"})


def alike(robots: Sequence[RobotConfig]) -> list[list[int]]:
    """Indices of robots that have the same terms with the same choices, and so differ in numbers alone."""
    found: dict[tuple[object, ...], list[int]] = {}
    for index, robot in enumerate(robots):
        found.setdefault(_terms_and_choices(robot.terms), []).append(index)
    return list(found.values())


def _terms_and_choices(terms: Terms) -> tuple[object, ...]:
    return tuple((name, *(value for _, value in values if isinstance(value, str))) for name, values in terms.present())


def stacked(robots: Sequence[RobotConfig], axes: int) -> RobotConfig:
    """One configuration for M robots with the same terms and choices.

    Args:
        robots: At least one.
        axes: How many axes follow that of the robots in what the numbers meet.

    Returns:
        Numbers in which the robots differ are (M, 1, ...); the others stay as they are. It is not valid by its schema
        and serves to be computed with alone.

    Raises:
        ValueError: They differ in something that is no number.
    """
    changed = {
        name: _joined([getattr(robot, name) for robot in robots], axes, f"robot.{name}")
        for name in RobotConfig.model_fields
        if name not in UNPHYSICAL
    }
    return robots[0].model_copy(update=changed)


def stacked_terms(robots: Sequence[RobotConfig], axes: int) -> Terms:
    """The terms of `stacked` alone."""
    return _joined([robot.terms for robot in robots], axes, "robot.terms")


def _joined(values: Sequence[Any], axes: int, path: str) -> Any:  # noqa: ANN401
    first = values[0]
    if all(value is first for value in values):
        return first
    if isinstance(first, Section):
        names = type(first).model_fields
        changed = {name: _joined([getattr(value, name) for value in values], axes, f"{path}.{name}") for name in names}
        return first.model_copy(update=changed)
    if all(value == first for value in values):
        return first
    if isinstance(first, (int, float)):
        return np.array(values, dtype=float).reshape(-1, *(1,) * axes)
    raise ValueError(f"{path}: robots that differ in it cannot be stacked")
