"""Every term: where it acts, what brings it about, what reveals it, its equation and parameters."""

from collections.abc import Iterator

from markdown import page, table, text

from physics.effects import PHYSICS_TERMS
from physics.effects.base import Term
from sensors.effects import SENSOR_TERMS

ABOUT = """What can be wrong in a robot, one by one; what all have in common, and what does not act everywhere, is in
[terms](../terms.md). Each is a setting, `robot.terms.<name>.<parameter>`, an axis of randomisation and a hypothesis
of the diagnosis. *null*: where it changes nothing; *start*: where a fit begins, with a visible effect."""


def terms() -> str:
    return page("Terms", ABOUT, (part for term in (*PHYSICS_TERMS, *SENSOR_TERMS) for part in _section(term)))


def _section(term: Term) -> Iterator[str]:
    yield f"## {term.name}"
    yield f"Slot *{term.slot}*. {_sentence(term.cause)}. Seen in: {text(term.excitation)}."
    for found in term.parameters.model_fields.values():
        if found.description:
            yield text(found.description)
    yield table(("parameter", "unit", "null", "start", "bounds"), _rows(term))
    choices = {name: next(iter(options), "any") for name, options in term.options.items()}
    values = term.start(choices).model_dump()
    yield "    " + " ".join(f"--set robot.terms.{term.name}.{name}={_number(value)}" for name, value in values.items())


def _rows(term: Term) -> Iterator[tuple[str, ...]]:
    for name, options in term.options.items():
        yield name, "-", "-", ", ".join(options), ""
    for name, number in term.numbers.items():
        null = "-" if number.null is None else f"{number.null:g}"
        yield name, number.unit, null, f"{number.start:g}", f"{number.low:g} ... {number.high:g}"


def _sentence(words: str) -> str:
    told = text(words)
    return told[:1].upper() + told[1:]


def _number(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
