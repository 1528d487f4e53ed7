"""The effects of one robot, at most one of each class: the section `robot.effects`."""

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any, TypeVar

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from configs.effects.base import Effect, Slot
from configs.effects.registry import EFFECTS, effects_section
from configs.schema.code_file import CodeFile
from configs.user_files import EFFECT_FILES

AnEffect = TypeVar("AnEffect", bound=Effect)


@dataclass(frozen=True)
class UnloadedEffect:
    """An effect of a user's own in a specification whose file is not loaded: its values are kept, and nothing acts."""

    name: str
    values: dict[str, Any]
    file: CodeFile
    """File that defines it."""


@cache
def _places(effects: tuple[type[Effect], ...]) -> dict[type[Effect], int]:
    """Return the place of each effect in the table; cached, because a diagnosis makes thousands of robots."""
    return {effect: place for place, effect in enumerate(effects)}


@dataclass(frozen=True)
class RobotEffects:
    """Immutable collection of effects, in the order in which they act, whatever the order in a file."""

    members: tuple[Effect, ...] = ()
    unloaded: tuple[UnloadedEffect, ...] = ()
    """Effects whose files are not loaded, as in a dataset that somebody else made; they come last."""

    def __post_init__(self) -> None:
        if len(self.members) > 1:
            place = _places(EFFECTS.classes())
            # An effect that is in no table yet, such as a law that a diagnosis tries, acts last.
            order = sorted(self.members, key=lambda effect: place.get(type(effect), len(place)))
            object.__setattr__(self, "members", tuple(order))

    def __iter__(self) -> Iterator[Effect]:
        return iter(self.members)

    def get(self, effect: type[AnEffect]) -> AnEffect | None:
        """Return the effect of this class, or None where the robot has none."""
        return next((member for member in self.members if isinstance(member, effect)), None)

    def in_slots(self, slots: Collection[Slot]) -> tuple[Effect, ...]:
        """Return the effects that act in some slots.

        Raises:
            InputError: The file of an effect is not loaded, so that its slot is not known.
        """
        self.require_loaded()
        return tuple(member for member in self.members if member.slot in slots)

    def functions(self, slot: Slot) -> tuple[Callable[..., Any], ...]:
        """Return the functions that act in a slot, one after the other.

        Raises:
            InputError: As for `in_slots`.
        """
        self.require_loaded()
        return tuple(member.apply for member in self.members if member.slot is slot)

    def require_loaded(self) -> None:
        """Check that every effect can act.

        Raises:
            InputError: The file of one is not loaded, or has changed.
        """
        for effect in self.unloaded:
            if (problem := EFFECT_FILES.problem(effect.file)) is not None:
                raise problem

    def with_effect(self, effect: Effect) -> "RobotEffects":
        """Return these effects and one more, which replaces one of its class."""
        members, unloaded = self._others(effect.name)
        return RobotEffects((*members, effect), unloaded)

    def without(self, name: str) -> "RobotEffects":
        """Return these effects without the one of this name."""
        return RobotEffects(*self._others(name))

    def _others(self, name: str) -> tuple[tuple[Effect, ...], tuple[UnloadedEffect, ...]]:
        return (
            tuple(member for member in self.members if member.name != name),
            tuple(effect for effect in self.unloaded if effect.name != name),
        )

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:  # noqa: ANN401
        """Validate against the effects that there are at that time: a user may have loaded one more."""
        del source, handler

        def validated(value: object) -> RobotEffects:
            if isinstance(value, RobotEffects):
                return value
            unloaded: tuple[UnloadedEffect, ...] = ()
            if isinstance(value, dict):
                unloaded = tuple(item for item in value.values() if isinstance(item, UnloadedEffect))
                value = {name: item for name, item in value.items() if not isinstance(item, UnloadedEffect)}
            section = effects_section().model_validate(value)
            return cls(tuple(effect for _, effect in section if effect is not None), unloaded)

        def as_mapping(effects: RobotEffects) -> dict[str, Effect | dict[str, Any]]:
            unloaded = {effect.name: effect.values for effect in effects.unloaded}
            return {effect.name: effect for effect in effects} | unloaded

        serialization = core_schema.plain_serializer_function_ser_schema(as_mapping)
        return core_schema.no_info_plain_validator_function(validated, ref=cls.__name__, serialization=serialization)

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        del schema
        return handler(effects_section().__pydantic_core_schema__)
