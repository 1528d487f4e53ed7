"""Many robots as one configuration whose numbers are arrays, for one pass of numpy over all of them."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from configs.schema.base import Section
from configs.schema.effects.parameter import Parameter
from configs.schema.effects.table import Terms
from configs.schema.robot import RobotConfig
from physics.effects import PHYSICS_TERMS
from physics.effects.base import Slot

UNPHYSICAL = frozenset({"name", "description"})
BENDING = frozenset(
    term.name for term in PHYSICS_TERMS if term.slot in {Slot.BRIDGE, Slot.SUPPLY, Slot.CURRENT_LIMIT, Slot.FRICTION}
)
"""Terms by which torque or friction of a motor is no straight line of its speed."""


def alike(robots: Sequence[RobotConfig]) -> list[list[int]]:
    """Indices of robots that can be stacked: none has a term that another has with another choice.

    A term that only some of them have is there for the others with its null value, which changes nothing. Play in the
    gears is a matter of its own, for it asks for far shorter steps, and so are bare motors, which take one exact step
    where others take some.
    """
    found: list[tuple[tuple[bool, bool], dict[str, tuple[str, ...]], list[int]]] = []
    for index, robot in enumerate(robots):
        chosen = {name: _choices(values) for name, values in robot.terms.present()}
        steps = "gear_backlash" in chosen, BENDING.isdisjoint(chosen)
        for of_steps, of_group, group in found:
            if of_steps == steps and all(of_group.get(name, choice) == choice for name, choice in chosen.items()):
                of_group.update(chosen)
                group.append(index)
                break
        else:
            found.append((steps, chosen, [index]))
    return [group for _, _, group in found]


def _choices(values: Section) -> tuple[str, ...]:
    return tuple(value for _, value in values if isinstance(value, str))


def _with_same_terms(robots: Sequence[RobotConfig]) -> list[Terms]:
    """Terms of robots that are alike, each with those of all of them."""
    some = {name: values for robot in robots for name, values in robot.terms.present()}
    nulls = {name: _null(values) for name, values in some.items()}
    missing = [{name: null for name, null in nulls.items() if getattr(of.terms, name) is None} for of in robots]
    return [of.terms.model_copy(update=lacks) if lacks else of.terms for of, lacks in zip(robots, missing, strict=True)]


def _null(values: Section) -> Section:
    """The same term without effect."""
    numbers = {
        name: parameter.start if parameter.null is None else parameter.null
        for name, field in type(values).model_fields.items()
        for parameter in field.metadata
        if isinstance(parameter, Parameter)
    }
    return values.model_copy(update=numbers)


def stacked(robots: Sequence[RobotConfig], axes: int, times: int = 1) -> RobotConfig:
    """One configuration for M robots that are alike.

    Args:
        robots: At least one.
        axes: How many axes follow that of the robots in what the numbers meet.
        times: Length of the first of them, if numpy is to run over it and the robots in one loop.

    Returns:
        Numbers in which the robots differ are (M, times, 1, ...); the others stay as they are. It is not valid by its
        schema and serves to be computed with alone.

    Raises:
        ValueError: They differ in something that is no number.
    """
    changed = {
        name: _joined([getattr(robot, name) for robot in robots], axes, times, f"robot.{name}")
        for name in RobotConfig.model_fields
        if name not in UNPHYSICAL and name != "terms"
    }
    changed["terms"] = stacked_terms(robots, axes, times)
    return robots[0].model_copy(update=changed)


def stacked_terms(robots: Sequence[RobotConfig], axes: int, times: int = 1) -> Terms:
    """The terms of `stacked` alone."""
    return _joined(_with_same_terms(robots), axes, times, "robot.terms")


def _joined(values: Sequence[Any], axes: int, times: int, path: str) -> Any:  # noqa: ANN401
    first = values[0]
    if all(value is first for value in values):
        return first
    if isinstance(first, Section):
        names = type(first).model_fields
        changed = {
            name: _joined([getattr(value, name) for value in values], axes, times, f"{path}.{name}") for name in names
        }
        return first.model_copy(update=changed)
    if all(value == first for value in values):
        return first
    if isinstance(first, (int, float)):
        return np.repeat(np.array(values, dtype=float), times).reshape(len(values), times, *(1,) * (axes - 1))
    raise ValueError(f"{path}: robots that differ in it cannot be stacked")
