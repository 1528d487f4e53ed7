"""The effects of one robot, at most one of each class: the section `robot.effects`."""

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
from typing import Any, TypeVar

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from configs.effects.base import Effect, Slot
from configs.effects.registry import EFFECTS, effects_section

AnEffect = TypeVar("AnEffect", bound=Effect)


@dataclass(frozen=True)
class RobotEffects:
    """Immutable collection of effects, in the order in which they act, whatever the order in a file."""

    members: tuple[Effect, ...] = ()

    def __post_init__(self) -> None:
        if len(self.members) > 1:
            place = {effect: place for place, effect in enumerate(EFFECTS.classes())}
            object.__setattr__(self, "members", tuple(sorted(self.members, key=lambda effect: place[type(effect)])))

    def __iter__(self) -> Iterator[Effect]:
        return iter(self.members)

    def get(self, effect: type[AnEffect]) -> AnEffect | None:
        """Return the effect of this class, or None where the robot has none."""
        return next((member for member in self.members if isinstance(member, effect)), None)

    def in_slots(self, slots: Collection[Slot]) -> tuple[Effect, ...]:
        """Return the effects that act in some slots."""
        return tuple(member for member in self.members if member.slot in slots)

    def functions(self, slot: Slot) -> tuple[Callable[..., Any], ...]:
        """Return the functions that act in a slot, one after the other."""
        return tuple(member.apply for member in self.members if member.slot is slot)

    def with_effect(self, effect: Effect) -> "RobotEffects":
        """Return these effects and one more, which replaces one of its class."""
        return RobotEffects((*self.without(effect.name), effect))

    def without(self, name: str) -> "RobotEffects":
        """Return these effects without the one of this name."""
        return RobotEffects(tuple(member for member in self.members if member.name != name))

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:  # noqa: ANN401
        """Validate against the effects that there are at that time: a user may have loaded one more."""
        del source, handler

        def validated(value: object) -> RobotEffects:
            if isinstance(value, RobotEffects):
                return value
            section = effects_section().model_validate(value)
            return cls(tuple(effect for _, effect in section if effect is not None))

        def as_mapping(effects: RobotEffects) -> dict[str, Effect]:
            return {effect.name: effect for effect in effects}

        serialization = core_schema.plain_serializer_function_ser_schema(as_mapping)
        return core_schema.no_info_plain_validator_function(validated, ref=cls.__name__, serialization=serialization)

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        del schema
        return handler(effects_section().__pydantic_core_schema__)
