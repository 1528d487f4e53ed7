"""Many robots as one configuration whose numbers are arrays, so that numpy computes all of them at once."""

from collections.abc import Sequence
from math import prod
from typing import Any

import numpy as np

from configs.effects.base import Effect, Slot
from configs.effects.robot_effects import RobotEffects
from configs.schema.base import Section
from configs.schema.robot import RobotConfig

TEXTS = frozenset({"name", "description"})
"""Fields of a robot that no computation uses."""
MOTOR_TORQUE_SLOTS = frozenset(
    {
        Slot.CONDUCTION,
        Slot.BRIDGE,
        Slot.SUPPLY,
        Slot.RESISTANCE,
        Slot.TORQUE_CONSTANT,
        Slot.WINDING_HEAT,
        Slot.CURRENT_LIMIT,
        Slot.FRICTION,
        Slot.SHAFT_TORQUE,
    }
)
"""Slots of effects with which a motor no longer has the torque and friction of a bare one, linear in its speed."""
SEPARATE_SLOTS = ({Slot.GEARBOX}, {Slot.CONDUCTION}, {Slot.SHAFT_TORQUE}, MOTOR_TORQUE_SLOTS)
"""Slots of effects that are computed separately, because they need far more steps than others."""


def stackable_groups(robots: Sequence[RobotConfig]) -> list[list[int]]:
    """Return groups of indices of robots that can be stacked.

    In a group no robot has an effect that another has with another choice, such as the side. An effect that only some
    of them have is added to the others with its null value, which changes nothing. Robots with play in the gears have
    groups of their own, because they need far shorter steps. So do bare motors, which take one exact step where others
    take some, and bridges that coast and torques that depend on the angle, which take far longer to compute.
    """
    groups: list[tuple[tuple[bool, ...], dict[type[Effect], tuple[str, ...]], list[int]]] = []
    for index, robot in enumerate(robots):
        choices = {type(effect): tuple(v for _, v in effect if isinstance(v, str)) for effect in robot.effects}
        steps = tuple(bool(robot.effects.in_slots(slots)) for slots in SEPARATE_SLOTS)
        for steps_of_group, choices_of_group, group in groups:
            if steps_of_group == steps and all(
                choices_of_group.get(k, choice) == choice for k, choice in choices.items()
            ):
                choices_of_group.update(choices)
                group.append(index)
                break
        else:
            groups.append((steps, choices, [index]))
    return [group for _, _, group in groups]


def stacked(robots: Sequence[RobotConfig], axes: int, lengths: tuple[int, ...] = ()) -> RobotConfig:
    """Return one configuration for M robots of one of the `stackable_groups`.

    Args:
        robots: At least one.
        axes: Number of axes after that of the robots in the arrays that the numbers are combined with.
        lengths: Lengths of the first of these axes, along which the numbers are repeated: small arrays of one shape are
            combined in half the time of those that broadcast to each other.

    Returns:
        Numbers in which the robots differ are (M, *lengths, 1, ...); the others stay as they are. The configuration is
        not valid by its schema and serves computations only.

    Raises:
        ValueError: They differ in something that is not a number.
    """
    shape = (*lengths, *(1,) * (axes - len(lengths)))
    changed = {
        name: _joined([getattr(robot, name) for robot in robots], shape, f"robot.{name}")
        for name in RobotConfig.model_fields
        if name not in TEXTS | {"effects"}
    }
    changed["effects"] = stacked_effects(robots, axes, lengths)
    return robots[0].model_copy(update=changed)


def stacked_effects(robots: Sequence[RobotConfig], axes: int, lengths: tuple[int, ...] = ()) -> RobotEffects:
    """Return the effects of `stacked` alone: each robot has those of all, without effect where it lacked one."""
    examples = {type(effect): effect for robot in robots for effect in robot.effects}
    by_kind = [{type(effect): effect for effect in robot.effects} for robot in robots]
    shape = (*lengths, *(1,) * (axes - len(lengths)))
    joined = []
    for kind, example in examples.items():
        without_effect = example.without_effect()
        members = [effects.get(kind, without_effect) for effects in by_kind]
        joined.append(_joined(members, shape, f"robot.effects.{kind.name}"))
    return RobotEffects(tuple(joined))


def _joined(values: Sequence[Any], shape: tuple[int, ...], path: str) -> Any:  # noqa: ANN401
    first = values[0]
    if all(value is first for value in values):
        return first
    if isinstance(first, Section):
        names = type(first).model_fields
        changed = {name: _joined([getattr(value, name) for value in values], shape, f"{path}.{name}") for name in names}
        return first.model_copy(update=changed)
    if all(value == first for value in values):
        return first
    if isinstance(first, (int, float)):
        return np.repeat(np.array(values, dtype=float), prod(shape)).reshape(len(values), *shape)
    raise ValueError(f"{path}: robots that differ in it cannot be stacked")
