"""What pydantic found wrong, told as this project tells it: place, field, what was got, what is allowed, cure."""

import re
from typing import Any

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from configs.errors import InputError, nearest, shown
from configs.shapes import Shape, shown_names
from configs.tree import FieldPath, Node, Values, dotted

_NUMBER_AND_UNIT = re.compile(r"\s*([-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?)\s*([A-Za-z°%]*)\s*")
_UNITS = {
    "mm": ("m", 1e-3), "cm": ("m", 1e-2), "m": ("m", 1.0), "ms": ("s", 1e-3), "s": ("s", 1.0),
    "g": ("kg", 1e-3), "kg": ("kg", 1.0), "mV": ("V", 1e-3), "V": ("V", 1.0), "deg": ("deg", 1.0), "°": ("deg", 1.0),
    "Hz": ("hz", 1.0), "kHz": ("hz", 1e3), "px": ("px", 1.0), "ohm": ("ohm", 1.0),
}  # fmt: skip
"""Unit of a value written as text -> the ending of a field's name, and the factor to it."""


def explained(error: ValidationError, root: Node, shape: Shape, values: Values) -> InputError:
    """The first fault as one line, with the number of further ones.

    Unknown keys come first: they are the cause where a missing field is the effect.
    """
    details = [(_path(tuple(fault["loc"]), root, shape), fault) for fault in error.errors(include_url=False)]
    unknown = [item for item in details if item[1]["type"] == "extra_forbidden"]
    path, fault = (unknown or details)[0]
    facts = _facts(path, fault, root, shape, values)
    if len(details) > 1:
        facts["cure"] = "; ".join(part for part in (facts.get("cure"), _and_more(len(details) - 1)) if part)
    return InputError(where=root.place_of(path), **facts)


def _and_more(count: int) -> str:
    return f"and {count} more fault{'s' if count > 1 else ''} after this one"


def _path(location: tuple[str | int, ...], root: Node, shape: Shape) -> FieldPath:
    """Pydantic's location without the names of union members that it puts between the keys."""
    path: FieldPath = ()
    node: Node | None = root
    here: Shape | None = shape
    for part in location:
        inner = node.child(part) if node else None
        if inner is None and (here is None or here.child(part, node) is None):
            continue
        here = here.child(part, node) if here else None
        path, node = (*path, part), inner
    return path


def _facts(path: FieldPath, fault: ErrorDetails, root: Node, shape: Shape, values: Values) -> dict[str, Any]:
    what = dotted(path) or "top level"
    kind = fault["type"]
    here = shape.at(path, root)
    if kind == "missing":
        return {"what": f"{what} is missing", "allowed": here.words() if here else ""}
    if kind == "extra_forbidden":
        return _unknown_key(path, root, shape)
    if kind in {"value_error", "field_pair"}:
        context = fault.get("ctx", {})
        return {"what": f"{what}: {fault['msg'].removeprefix('Value error, ')}", "cure": context.get("cure", "")}
    got = fault["input"]
    facts: dict[str, Any] = {"what": what, "got": got, "allowed": here.words() if here else fault["msg"]}
    if here is not None and here.tag_key:
        tag = got.get(here.tag_key) if isinstance(got, dict) else None
        facts["nearest"] = f"{here.tag_key}: {close}" if (close := nearest(tag, here.tags)) else ""
    elif here is not None and "enum" in here.schema:
        facts["nearest"] = nearest(got, [str(option) for option in here.schema["enum"]])
    facts["cure"] = _of_distribution(path, root) if path in values else _cure(path, got, here)
    return facts


def _unknown_key(path: FieldPath, root: Node, shape: Shape) -> dict[str, Any]:
    above, key = path[:-1], str(path[-1])
    parent, node = shape.at(above, root) or shape, root.at(above) or root
    known = list(parent.known_keys(node))
    missing = [name for name in known if node.child(name) is None]
    close = nearest(key, missing) or nearest(key, known)
    facts = {"what": f"{dotted(path)}: unknown key", "allowed": shown_names(known), "nearest": close}
    if key == "extends":
        facts["cure"] = "'extends' may stand at the top of a file and directly in arena, robot and look"
    elif not close:
        facts["nearest"] = next((dotted(place) for place in shape.paths() if place[-1] == key), "")
    return facts


def _of_distribution(path: FieldPath, root: Node) -> str:
    node = root.at(path)
    cure = f"it is a value that {shown(node.plain())} can draw" if node else ""
    if node and node.child("normal") and "low" not in dict(node.value["normal"].children()):  # type: ignore[index,call-overload]
        return f"{cure}, which reaches 4 sd from the mean; give {{mean, sd, low, high}} to limit it"
    return cure


def _cure(path: FieldPath, got: object, shape: Shape | None) -> str:
    """What to do about a value of the wrong type, or an empty string."""
    if shape is None:
        return ""
    number_wanted = shape.is_number or shape.is_integer
    if number_wanted and isinstance(got, str):
        return _cure_of_text(str(path[-1]), got)
    if shape.is_integer and isinstance(got, float) and got.is_integer():
        return f"write {int(got)}, without a decimal point or exponent"
    if shape.types == {"string"} and isinstance(got, bool | int | float):
        return "put it in quotes to make it text"
    if shape.types == {"boolean"} and str(got).lower() in {"yes", "on", "y", "1"}:
        return "write true"
    if shape.types == {"boolean"} and str(got).lower() in {"no", "off", "n", "0"}:
        return "write false"
    return ""


def _cure_of_text(field: str, text: str) -> str:
    """What to write instead of a text that was meant as a number."""
    if re.fullmatch(r"\s*[-+]?[0-9]+,[0-9]+\s*", text):
        return "write decimals with a point, " + text.strip().replace(",", ".")
    if re.fullmatch(r"[0-9]{1,3}([_' ][0-9]{3})+", text):
        return "write the digits without separators, " + re.sub(r"[_' ]", "", text)
    found = _NUMBER_AND_UNIT.fullmatch(text)
    try:
        number = float(found[1]) if found else None
    except ValueError:
        number = None
    if not found or number is None:
        return ""
    if not found[2]:
        return f"write the number without quotes or leading zeros, {number:.12g}"
    ending, factor = _UNITS.get(found[2], ("", 0.0))
    if ending and field.lower().endswith(f"_{ending.lower()}"):
        return f"write the number alone, in the unit of the field's name: {number * factor:.12g}"
    return "write the number alone, in the unit of the field's name"
