"""Every effect: where it acts, what brings it about, what reveals it, its equation and parameters."""

from collections.abc import Iterator

from markdown import page, table, text

from configs.effects.base import Effect
from configs.effects.registry import EFFECTS

ABOUT = """All effects that a robot can have, one by one. [Effects](../effects.md) explains what they have in common.
Each is a setting, `robot.effects.<name>.<parameter>`, an axis of randomisation and a hypothesis of the diagnosis.
*null*: value at which the effect changes nothing; *start*: plausible value that shows, where a fit begins."""


def effects() -> str:
    return page("Effects", ABOUT, (part for effect in EFFECTS.classes() for part in _section(effect)))


def _section(effect: type[Effect]) -> Iterator[str]:
    yield f"## {effect.name}"
    yield f"Slot *{effect.slot}*. {_sentence(effect.cause)}. Seen in: {text(effect.excitation)}."
    yield f"The diagnosis looks for it in measurements of: {', '.join(effect.setups)}."
    for found in effect.model_fields.values():
        if found.description:
            yield text(found.description)
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


def _sentence(words: str) -> str:
    told = text(words)
    return told[:1].upper() + told[1:]


def _number(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
