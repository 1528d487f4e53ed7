"""The table of all effects: those of the project, and those of files that a user loads."""

import inspect

from configs.effects.arguments import ARGUMENTS, takes_arguments
from configs.effects.base import Effect, Slot
from configs.families import Family, optional_sections
from configs.schema.base import Section
from symolo.core.errors import InputError


def effects_section() -> type[Section]:
    """Return the schema of `robot.effects`: at most one effect of each name, and no key means no effect."""
    return optional_sections("RobotEffects", tuple(EFFECTS.by_name().items()))


def _check(effect: type[Effect], where: str) -> None:
    missing = [name for name in ("slot", "cause", "excitation") if not hasattr(effect, name)]
    if missing:
        cure = 'write, for example, slot = Slot.RANGE, cause = "..." and excitation = "..."'
        raise InputError(f"effect {effect.name}: {', '.join(missing)} missing", where=where, cure=cure)
    if not isinstance(effect.slot, Slot):
        allowed = ", ".join(f"Slot.{slot.name}" for slot in Slot)
        raise InputError(f"effect {effect.name}: slot", where=where, got=effect.slot, allowed=allowed)
    for name, values in effect.options().items():
        if not values and effect.model_fields[name].annotation is not str:
            cure = f'write {name}: Annotated[float, Parameter("m", null=0.0, start=0.1, low=-1.0, high=1.0)]'
            raise InputError(f"effect {effect.name}: {name} is no parameter", where=where, cure=cure)
    for name, parameter in effect.parameters().items():
        if parameter.std is not None and not parameter.std > 0.0:
            cure = "state the standard error of the start, or leave std out"
            raise InputError(f"effect {effect.name}: std of {name}", where=where, got=parameter.std, cure=cure)
    if effect.apply is Effect.apply:
        cure = "define apply(self, ...), with the arguments that `Slot` lists"
        raise InputError(f"effect {effect.name}: apply missing", where=where, cure=cure)
    if not takes_arguments(effect):
        allowed = f"(self, {ARGUMENTS[effect.slot]}) in Slot.{effect.slot.name}; the names are free"
        raise InputError(
            f"effect {effect.name}: arguments of apply",
            where=where,
            got=f"({', '.join(inspect.signature(effect.apply).parameters)})",
            allowed=allowed,
        )
    if all(parameter.null is None for parameter in effect.parameters().values()):
        cure = "annotate a field, for example offset_m: Annotated[float, Parameter('m', null=0.0, start=0.1, ...)]"
        raise InputError(f"effect {effect.name}: no parameter has a null value", where=where, cure=cure)


EFFECTS: Family[Effect] = Family("effect", Effect, "EFFECTS", ("physics.effects", "sensors.effects"), _check)
"""All effects in the order in which they act. The packages stand in the order in which the effects of a slot act; those
of loaded files act last. A loaded effect is a config key and a hypothesis of the diagnosis like any other."""
