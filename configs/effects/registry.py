"""Which effects there are: those of the project, and those of files that a user loads."""

from collections.abc import Mapping
from pathlib import Path

from configs.effects.base import Effect, Slot
from configs.families import Family, optional_sections
from configs.schema.base import Section
from symolo.core.errors import InputError


def effect_classes() -> tuple[type[Effect], ...]:
    """Return all effects in the order in which they act; those of loaded files act last in their slot."""
    return EFFECTS.classes()


def effects_by_name() -> Mapping[str, type[Effect]]:
    """Return all effects by their names, which are the keys of `robot.effects`."""
    return EFFECTS.by_name()


def effects_section() -> type[Section]:
    """Return the schema of `robot.effects`: at most one effect of each name, and no key means no effect."""
    return optional_sections("RobotEffects", tuple((effect.name, effect) for effect in effect_classes()))


def load_effect_file(path: str | Path) -> type[Effect]:
    """Add the effect of a Python file, which from now on is a config key and a hypothesis like any other.

    Args:
        path: File with one class that derives from `Effect`. A file that is loaded already changes nothing.

    Raises:
        InputError: There is no such file, it cannot be executed, or its effect is not complete.
    """
    return EFFECTS.load(path)


def unload_effect_file(path: str | Path) -> None:
    """Forget the effect of a file that was loaded."""
    EFFECTS.unload(path)


def _check(effect: type[Effect], where: str) -> None:
    missing = [name for name in ("slot", "cause", "excitation") if not hasattr(effect, name)]
    if missing:
        cure = 'write, for example, slot = Slot.RANGE, cause = "..." and excitation = "..."'
        raise InputError(f"effect {effect.name}: {', '.join(missing)} missing", where=where, cure=cure)
    if not isinstance(effect.slot, Slot):
        allowed = ", ".join(f"Slot.{slot.name}" for slot in Slot)
        raise InputError(f"effect {effect.name}: slot", where=where, got=effect.slot, allowed=allowed)
    if effect.apply is Effect.apply:
        cure = "define apply(self, ...), with the arguments that `Slot` lists"
        raise InputError(f"effect {effect.name}: apply missing", where=where, cure=cure)
    if all(parameter.null is None for parameter in effect.parameters().values()):
        cure = "annotate a field, for example offset_m: Annotated[float, Parameter('m', null=0.0, start=0.1, ...)]"
        raise InputError(f"effect {effect.name}: no parameter has a null value", where=where, cure=cure)


EFFECTS: Family[Effect] = Family("effect", Effect, "EFFECTS", ("physics.effects", "sensors.effects"), _check)
"""The packages stand in the order in which the effects of a slot act."""
