"""Texts about effects for a terminal: all in a line each, and one with all that is known about it."""

from collections.abc import Iterator

from configs.effects.base import Effect, Slot
from configs.effects.registry import EFFECTS
from pipeline.effects.trial import ANY_NAME
from symolo.core.field_descriptions import field_descriptions


def effect_lines(slot: Slot | None = None) -> Iterator[str]:
    """Yield one line for each effect: name, slot and cause."""
    effects = [effect for effect in EFFECTS.classes() if slot is None or effect.slot is slot]
    wide = max(len(effect.name) for effect in EFFECTS.classes())
    user_files = EFFECTS.files
    for effect in effects:
        mark = " (your own)" if effect.name in user_files else ""
        yield f"{effect.name:<{wide}}  {effect.slot:<15}  {effect.cause}{mark}"


def effect_text(effect: type[Effect]) -> Iterator[str]:
    """Yield the lines about one effect."""
    yield effect.name
    if effect.__doc__:
        yield f"  meaning:     {' '.join(effect.__doc__.split())}"
    yield f"  slot:        {effect.slot}"
    yield f"  cause:       {effect.cause}"
    yield f"  seen in:     {effect.excitation}"
    yield f"  diagnosed:   {', '.join(effect.setups) or 'in no measurement'}"
    if (file := EFFECTS.files.get(effect.name)) is not None:
        yield f"  file:        {file.path} (SHA-256 {file.sha256})"
    descriptions = field_descriptions(effect)
    for name in effect.model_fields:
        number = effect.parameters().get(name)
        if number is None:
            yield f"  {name}: {' | '.join(effect.options()[name]) or 'any name'}"
        else:
            null = "no null value" if number.null is None else f"null {number.null:g}"
            unit = "" if number.unit == "1" else f" {number.unit}"
            yield f"  {name}: {number.low:g} ... {number.high:g}{unit}, {null}, start {number.start:g}"
        if name in descriptions:
            yield f"    {' '.join(descriptions[name].split())}"
    option = f"--effect-file {EFFECTS.files[effect.name].path.name} " if effect.name in EFFECTS.files else ""
    settings = " ".join(f"--set {setting}" for setting in settings_of(effect))
    yield f"  try it:      symolo {option}simulate smoke {settings} --out data"


def settings_of(effect: type[Effect]) -> tuple[str, ...]:
    """Return the start values as settings of a scenario."""
    choices = {name: next(iter(options or ANY_NAME[name])) for name, options in effect.options().items()}
    values = effect.start(choices).model_dump()
    shown = {name: f"{value:g}" if isinstance(value, float) else value for name, value in values.items()}
    return tuple(f"robot.effects.{effect.name}.{name}={value}" for name, value in shown.items())
