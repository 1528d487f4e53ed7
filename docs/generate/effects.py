"""Every effect: where it acts, what causes it, what reveals it, its equation and its parameters."""

import ast
import inspect
from collections.abc import Iterator
from dataclasses import fields
from itertools import pairwise

from markdown_text import page, table, text

from configs.effects.base import Effect, Slot
from configs.effects.registry import EFFECTS
from physics.drivetrain.bridge import Bridge, Chopper
from physics.drivetrain.motion import ShaftMotion
from physics.drivetrain.two_mass import Load, TwoMass
from physics.robot.floor_place import FloorPlace
from physics.robot.wheel_geometry import WheelGeometry
from pipeline.effects.template_laws import LAWS
from sensors.ranging.range_view import RangeView
from symolo.core.field_descriptions import field_descriptions

ABOUT = """This page lists all effects that a robot can have. The page [effects](../effects.md) explains what they have
in common. Each effect is a setting, `robot.effects.<name>.<parameter>`, an axis of randomisation and a hypothesis of
the diagnosis. *null* is the value at which the effect changes nothing. *start* is a plausible value with a visible
effect, at which a fit begins."""
ARGUMENTS = (RangeView, ShaftMotion, FloorPlace, WheelGeometry, Chopper, Bridge, TwoMass, Load)
"""Classes of the arguments of `apply` that have several fields."""


def effects() -> str:
    parts = [*_slots(), *_arguments(), *(part for effect in EFFECTS.classes() for part in _section(effect))]
    return page("Effects", ABOUT, parts)


def _slots() -> Iterator[str]:
    yield "## Slots"
    yield (
        "The place of the signal chain where an effect acts. `apply` gets the arguments on the left, and returns the "
        "first one, changed. A turn or a duration is that of one step of the simulation; steps have other lengths in "
        "PyBullet than in a fit, so the change per second must not depend on them."
    )
    yield (
        "An [effect of your own](../own_effects.md) may have any slot. `symolo effect new NAME --slot SLOT` writes a "
        "file to begin with for those that have *yes* in the last column; for the others, begin with a copy of the "
        "shipped effect that the command names."
    )
    words = dict(_documented(Slot))
    rows = [(slot.value, text(words[slot.name]), "yes" if slot in LAWS else "") for slot in Slot]
    yield table(("slot", "arguments and result of `apply`", "`effect new`"), rows)


def _arguments() -> Iterator[str]:
    yield "## Arguments with several fields"
    yield "Names end in their units."
    for argument in ARGUMENTS:
        yield f"### {argument.__name__}"
        yield f"`from {argument.__module__} import {argument.__name__}`"
        words = dict(_documented(argument))
        rows = [(f"`{field.name}`", text(words.get(field.name, ""))) for field in fields(argument)]
        yield table(("field", "meaning"), rows)


def _documented(members: type) -> Iterator[tuple[str, str]]:
    """Yield the names of a class's attributes with the texts below them."""
    body = getattr(ast.parse(inspect.getsource(members)).body[0], "body", [])
    for attribute, words in pairwise(body):
        if not (isinstance(words, ast.Expr) and isinstance(words.value, ast.Constant)):
            continue
        if isinstance(attribute, ast.Assign | ast.AnnAssign):
            name = attribute.targets[0] if isinstance(attribute, ast.Assign) else attribute.target
            yield ast.unparse(name), " ".join(str(words.value.value).split())


def _section(effect: type[Effect]) -> Iterator[str]:
    yield f"## {effect.name}"
    yield text(inspect.getdoc(effect) or "")
    yield f"Slot: *{effect.slot}*. Possible causes: {text(effect.cause)}. Seen in: {text(effect.excitation)}."
    places = f"in these measurements: {', '.join(effect.setups)}" if effect.setups else "in no measurement"
    yield f"The diagnosis looks for it {places}."
    yield table(("parameter", "unit", "null", "start", "bounds", "meaning"), _rows(effect))
    choices = {name: next(iter(options), "any") for name, options in effect.options().items()}
    values = effect.start(choices).model_dump()
    yield "    " + " ".join(
        f"--set robot.effects.{effect.name}.{name}={_number(value)}" for name, value in values.items()
    )


def _rows(effect: type[Effect]) -> Iterator[tuple[str, ...]]:
    meanings = field_descriptions(effect)
    for name, options in effect.options().items():
        yield name, "-", "-", "-", ", ".join(options) or "any name", text(meanings.get(name, ""))
    for name, number in effect.parameters().items():
        null = "-" if number.null is None else f"{number.null:g}"
        bounds = f"{number.low:g} ... {number.high:g}"
        yield name, number.unit, null, f"{number.start:g}", bounds, text(meanings.get(name, ""))


def _number(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
