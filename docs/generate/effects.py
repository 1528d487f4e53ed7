"""Every effect: where it acts, what causes it, what reveals it, its equation and its parameters."""

from collections.abc import Iterator

from markdown_text import page, table, text

from configs.effects.base import Effect
from configs.effects.registry import EFFECTS

ABOUT = """This page lists all effects that a robot can have. The page [effects](../effects.md) explains what they have
in common. Each effect is a setting, `robot.effects.<name>.<parameter>`, an axis of randomisation and a hypothesis of
the diagnosis. *null* is the value at which the effect changes nothing. *start* is a plausible value with a visible
effect, at which a fit begins."""


def effects() -> str:
    return page("Effects", ABOUT, (part for effect in EFFECTS.classes() for part in _section(effect)))


def _section(effect: type[Effect]) -> Iterator[str]:
    yield f"## {effect.name}"
    yield f"Slot: *{effect.slot}*. Possible causes: {text(effect.cause)}. Seen in: {text(effect.excitation)}."
    places = f"in these measurements: {', '.join(effect.setups)}" if effect.setups else "in no measurement"
    yield f"The diagnosis looks for it {places}."
    for field in effect.model_fields.values():
        if field.description:
            yield text(field.description)
    yield table(("parameter", "unit", "null", "start", "bounds"), _rows(effect))
    choices = {name: next(iter(options), "any") for name, options in effect.options().items()}
    values = effect.start(choices).model_dump()
    yield "    " + " ".join(
        f"--set robot.effects.{effect.name}.{name}={_number(value)}" for name, value in values.items()
    )


def _rows(effect: type[Effect]) -> Iterator[tuple[str, ...]]:
    for name, options in effect.options().items():
        yield name, "-", "-", ", ".join(options), ""
    for name, number in effect.parameters().items():
        null = "-" if number.null is None else f"{number.null:g}"
        yield name, number.unit, null, f"{number.start:g}", f"{number.low:g} ... {number.high:g}"


def _number(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
