"""Which effects there are: those of the project, and those of files that a user loads.

Effects stand above this package, since they compute with motors, wheels and sensors. They are therefore found by name,
when they are needed for the first time.
"""

import importlib
import sys
import traceback
from collections.abc import Mapping
from functools import cache
from hashlib import sha256
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import MappingProxyType, ModuleType

from pydantic import Field, create_model

from configs.effects.base import Effect, Slot
from configs.schema.base import Section, absent
from symolo.core.errors import InputError

PACKAGES = ("physics.effects", "sensors.effects")
"""Each names its modules, one effect each, in `EFFECTS`. This is the order in which the effects of a slot act."""

_loaded: dict[Path, type[Effect]] = {}
"""Effects of files outside the project, in the order of loading."""


def effect_classes() -> tuple[type[Effect], ...]:
    """Return all effects in the order in which they act; those of loaded files act last in their slot."""
    return (*_shipped(), *_loaded.values())


def effects_by_name() -> Mapping[str, type[Effect]]:
    """Return all effects by their names, which are the keys of `robot.effects`."""
    return _by_name(effect_classes())


def effects_section() -> type[Section]:
    """Return the schema of `robot.effects`: at most one effect of each name, and no key means no effect."""
    return _section(effect_classes())


def load_effect_file(path: str | Path) -> type[Effect]:
    """Add the effect of a Python file, which from now on is a config key and a hypothesis like any other.

    Args:
        path: File with one class that derives from `Effect`. A file that is loaded already changes nothing.

    Raises:
        InputError: There is no such file, it cannot be executed, or its effect is not complete.
    """
    file = Path(path).resolve()
    if file not in _loaded:
        if not file.is_file():
            raise InputError("effect file: no such file", got=str(path), allowed="a Python file with one effect")
        effect = _only_effect(_executed(file))
        if effect.name in effects_by_name():
            cure = "give the class another name"
            raise InputError(f"effect {effect.name}: the name is taken", where=str(file), cure=cure)
        _loaded[file] = effect
    return _loaded[file]


def unload_effect_file(path: str | Path) -> None:
    """Forget the effect of a file that was loaded."""
    sys.modules.pop(_loaded.pop(Path(path).resolve()).__module__, None)


@cache
def _shipped() -> tuple[type[Effect], ...]:
    return tuple(
        _only_effect(importlib.import_module(f"{package}.{name}"))
        for package in PACKAGES
        for name in importlib.import_module(package).EFFECTS
    )


@cache
def _by_name(classes: tuple[type[Effect], ...]) -> Mapping[str, type[Effect]]:
    return MappingProxyType({effect.name: effect for effect in classes})


@cache
def _section(classes: tuple[type[Effect], ...]) -> type[Section]:
    fields = {effect.name: (effect | None, Field(default_factory=absent)) for effect in classes}
    return create_model("RobotEffects", __base__=Section, **fields)  # type: ignore[call-overload]


def _executed(file: Path) -> ModuleType:
    name = f"effect_file_{file.stem}_{sha256(str(file).encode()).hexdigest()[:8]}"
    spec = spec_from_file_location(name, file)
    if spec is None or spec.loader is None:
        raise InputError("effect file", got=str(file), allowed="a Python file, which ends in .py")
    module = sys.modules[name] = module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except Exception as error:  # a user's file may raise whatever it likes
        del sys.modules[name]
        lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == str(file)]
        what, line = (error.msg, error.lineno) if isinstance(error, SyntaxError) else (error, lines[-1])
        raise InputError(f"effect file: {type(error).__name__}: {what}", where=f"{file}:{line}") from error
    return module


def _only_effect(module: ModuleType) -> type[Effect]:
    """Return the effect that a module defines, once it is known to be complete."""
    classes = [
        thing
        for thing in vars(module).values()
        if isinstance(thing, type) and issubclass(thing, Effect) and thing.__module__ == module.__name__
    ]
    where = str(module.__file__)
    if len(classes) != 1:
        names = ", ".join(effect.__name__ for effect in classes) or "none"
        raise InputError("effect file", where=where, got=names, allowed="one class that derives from Effect")
    (effect,) = classes
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
    return effect
