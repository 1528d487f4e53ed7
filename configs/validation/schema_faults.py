"""Faults that pydantic reports, as errors of this project: place, field, value, what is allowed, cure."""

import re

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from configs.schema.base import FIELDS_DISAGREE
from configs.validation.faults import SETTING, ConfigFault
from configs.validation.other_units import other_unit
from configs.validation.shapes import Shape, shown_names
from symolo.core.errors import InputError, nearest
from symolo.core.yaml.tree import ALTERNATIVES, FieldPath, Node, dotted

_NUMBER_AND_UNIT = re.compile(r"\s*([-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?)\s*([A-Za-z°%]*)\s*")
_UNITS = {
    "mm": ("m", 1e-3), "cm": ("m", 1e-2), "m": ("m", 1.0), "ms": ("s", 1e-3), "s": ("s", 1.0),
    "g": ("kg", 1e-3), "kg": ("kg", 1.0), "mV": ("V", 1e-3), "V": ("V", 1.0), "deg": ("deg", 1.0), "°": ("deg", 1.0),
    "Hz": ("hz", 1.0), "kHz": ("hz", 1e3), "px": ("px", 1.0), "ohm": ("ohm", 1.0),
}  # fmt: skip
"""Unit of a value written as text -> unit at the end of the field's name, and the factor to it."""

NOT_FLAT = frozenset({"ramp", "ramps", "slope", "slopes", "stairs", "steps", "pitch_deg", "roll_deg", "tilt_deg"})
"""Keys of an arena by which users try to describe a floor that is no plane."""
IMAGE_RATE = frozenset({"rate_hz", "period_s", "fps", "frame_rate", "frame_rate_hz", "frame_hz", "image_hz"})
"""Keys by which users try to give the rate of the images of data.csv."""
OTHER_NAMES = (
    ("radius", "diameter", "write twice the radius"),
    ("diameter", "radius", "write half of the diameter"),
    ("pitch_down", "pitch_up", "change the sign"),
    ("pitch_up", "pitch_down", "change the sign"),
)
"""Words in the names of keys, the words of the fields that have the other measure, and what to write there."""
OWN_SENSOR = "a kind of your own needs its file: robot.sensor_files, or symolo --sensor-file FILE ..."
MAX_PLACES = 3
"""Largest number of sections that are named for a key that stands in the wrong one."""
FLAT_FLOOR = (
    "the floor is a plane: ramps, steps and tilted things cannot be simulated; for a floor that slopes everywhere, use"
    " robot.effects.floor_slope"
)


def all_explained(error: ValidationError, root: Node, shape: Shape) -> list[InputError]:
    """Return every fault as an error of one line.

    Unknown keys come first, and a field that is missing because its key is misspelt is not reported a second time.
    """
    faults = [fault for fault in error.errors(include_url=False) if not _is_echo(fault)]
    faults.sort(key=lambda fault: fault["type"] != "extra_forbidden")
    explained = [(fault["type"], _fault(_path(fault, root, shape), fault, root, shape)) for fault in faults]
    misspelt = {(*fault.path[:-1], fault.nearest) for kind, fault in explained if kind == "extra_forbidden"}
    return [fault.error(root) for kind, fault in explained if not (kind == "missing" and fault.path in misspelt)]


def _is_echo(fault: ErrorDetails) -> bool:
    """Return whether a fault repeats another: a list with a faulty item is also reported as too short."""
    return fault["type"] == "too_short" and len(fault["input"]) >= fault.get("ctx", {})["min_length"]


def _path(fault: ErrorDetails, root: Node, shape: Shape) -> FieldPath:
    """Return the path of a fault: pydantic's location without the names of union members between the keys."""
    path: FieldPath = ()
    node: Node | None = root
    here: Shape | None = shape
    field = fault.get("ctx", {}).get("field")
    for part in (*fault["loc"], field) if field else fault["loc"]:
        inner = node.child(part) if node else None
        if inner is None and (here is None or here.child(part, node) is None):
            continue
        here = here.child(part, node) if here else None
        path, node = (*path, part), inner
    return path


def _fault(path: FieldPath, fault: ErrorDetails, root: Node, shape: Shape) -> ConfigFault:
    here = shape.at(path, root)
    if fault["type"] == "extra_forbidden":
        return _unknown_key(path, root, shape)
    if here is None:  # not a field of ours; pydantic's message is better than none
        return ConfigFault(path, fault["msg"])
    if fault["type"] == "missing":
        return ConfigFault(path, "missing", allowed=here.words())
    context = fault.get("ctx", {})
    if fault["type"] == FIELDS_DISAGREE:
        against, cure = _changed_beside(path, root), context["cure"]
        return ConfigFault(path, got=context["got"], allowed=context["allowed"], against=against, cure=cure)
    got = fault["input"]
    if here.tag_key and isinstance(got, dict):
        return _unknown_tag(path, got, here)
    close = nearest(got, [str(option) for option in here.schema.get("enum", [])])
    return ConfigFault(path, got=got, allowed=here.words(), nearest=close, cure=_cure(path, got, here))


def _unknown_tag(path: FieldPath, got: dict[str, object], here: Shape) -> ConfigFault:
    """Return the fault of a mapping whose field for the kind, `tag_key`, is missing or has an unknown value."""
    place, tag, allowed = (*path, here.tag_key), got.get(here.tag_key), f"one of {shown_names(here.tags)}"
    close = nearest(tag or (path[-1] if path else ""), here.tags)
    cure = OWN_SENSOR if path[:2] == ("robot", "sensors") and not close else ""
    if tag is None:
        return ConfigFault(place, "missing", allowed=allowed, nearest=close, cure=cure)
    return ConfigFault(place, got=tag, allowed=allowed, nearest=close, cure=cure)


def _changed_beside(path: FieldPath, root: Node) -> FieldPath:
    """Return the first field of the same section that the command line changes, unless it is this one."""
    above = root.at(path[:-1])
    if not path or above is None or root.place_of(path).startswith(SETTING):
        return ()
    return next(((*path[:-1], key) for key, node in above.children() if node.where.startswith(SETTING)), ())


def _unknown_key(path: FieldPath, root: Node, shape: Shape) -> ConfigFault:
    above, key = path[:-1], str(path[-1])
    parent, node = shape.at(above, root) or shape, root.at(above) or root
    known = list(parent.known_keys(node))
    value = node.child(key)
    fitting = [name for name in known if _takes(parent.child(name, node), value)]
    missing = [name for name in fitting if node.child(name) is None]
    without_unit = next((name for name in missing if name.startswith(f"{key}_")), "")
    close, cure = _other_measure(key, value, known)
    close = close or nearest(key, missing) or without_unit or nearest(key, fitting)
    if above[:1] == ("arena",) and key in NOT_FLAT:
        close, cure = "", FLAT_FLOOR
    elif key == "extends":
        cure = "'extends' is allowed at the top of a file and directly in arena, robot and look"
    elif key in IMAGE_RATE and above in {("robot", "camera"), ("render",), ("rates",)}:
        close = "rates.camera_hz"
    elif above == ("robot", "effects"):
        cure = "an effect of your own needs its file: robot.effect_files, or symolo --effect-file FILE ..."
    elif cure:
        pass
    elif not close and len(missing) == 1 and missing == known:
        close = missing[0]
    elif not close:
        close, cure = _elsewhere(above, key, root, shape)
    return ConfigFault(path, "unknown key", allowed=shown_names(known), nearest=close, cure=cure)


def _takes(shape: Shape | None, value: Node | None) -> bool:
    """Return whether a field may have been meant by the key of a value: a section is not a misspelt number or text."""
    is_section = value is not None and isinstance(value.value, dict) and not value.is_distribution
    return not is_section or shape is None or not shape.is_leaf


def _elsewhere(above: FieldPath, key: str, root: Node, shape: Shape) -> tuple[str, str]:
    """Return the path of a field for which an unknown key stands in the wrong section, and what to do about it."""
    here, node = shape.at(above, root) or shape, root.at(above)
    for section in here.known_keys(node):
        inner, field = here.child(section, node), key.removeprefix(f"{section}_")
        if inner is not None and field != key and field in inner.known_keys():
            return dotted((*above, section, field)), ""
    # Settings of a scenario that takes its robots from a diagnosis are no place for those of another section.
    places = [place for place in shape.top_places.get(key, ()) if len(place) == 1 or place[0] != "like"]
    if any(len(place) == 1 for place in places):
        return "", f"write {key} at the top of the scenario"
    return " or ".join(dotted(place) for place in places[:MAX_PLACES]), ""


def _other_measure(key: str, node: Node | None, known: list[str]) -> tuple[str, str]:
    """Return the field that has the measure of an unknown key in another form, and what to write; else empty texts."""
    for word, other, cure in OTHER_NAMES:
        if key.replace(word, other) in known and word in key:
            return key.replace(word, other), cure
    full_name = key.replace("fov", "field_of_view")
    if full_name in known or f"{full_name}_deg" in known:
        return full_name if full_name in known else f"{full_name}_deg", ""
    rate_hz = node.value if node else None
    if key == "rate_hz" and ALTERNATIVES[key] in known:
        such_as = f", such as {1.0 / rate_hz:.4g}" if isinstance(rate_hz, int | float) and rate_hz > 0 else ""
        return ALTERNATIVES[key], f"write 1 / rate_hz{such_as}"
    return "", ""


def _cure(path: FieldPath, got: object, shape: Shape) -> str:
    """Return what to do about a value of the wrong type, or an empty string."""
    if (shape.is_number or shape.is_integer) and isinstance(got, str):
        return _cure_of_text(str(path[-1]), got)
    if isinstance(got, int | float) and not isinstance(got, bool) and (hint := _cure_of_size(path, got, shape)):
        return hint
    if got == 0 and (cure := _cure_of_zero(path)):
        return cure
    if shape.is_integer and isinstance(got, float) and got.is_integer():
        return f"write {int(got)}, without a decimal point or exponent"
    if path[-1:] == ("counts_per_revolution",) and isinstance(got, float) and got >= 4.0:
        return (
            f"round the number of a geared encoder to {round(got)}, with which wheels and odometry are then simulated"
        )
    if shape.types == {"string"} and isinstance(got, bool | int | float):
        return "put it in quotes to make it text"
    if shape.types == {"array"} and isinstance(got, dict):
        return "write a list, each item after '- '"
    if shape.types == {"boolean"} and str(got).lower() in {"yes", "on", "y", "1"}:
        return "write true"
    if shape.types == {"boolean"} and str(got).lower() in {"no", "off", "n", "0"}:
        return "write false"
    return ""


def _cure_of_zero(path: FieldPath) -> str:
    """Return what to do about a zero where a number above it is needed; empty for most fields."""
    if path[-3:-2] == ("waypoints",) and path[-1] == "t_s":
        return "leave this waypoint out: at t = 0, the obstacle is at its `center`"
    if path[:1] == ("routes",) and path[-1] == "runs":
        return "to leave a route out, write the list `routes` without it (docs/scenarios.md)"
    return ""


def _cure_of_size(path: FieldPath, got: float, shape: Shape) -> str:
    """Return the question whether a number out of its bounds has another unit; empty where that is no reason."""
    field = "_m" if path[:1] == ("arena",) and isinstance(path[-1], int) else str(path[-1])
    low = shape.schema.get("minimum", shape.schema.get("exclusiveMinimum"))
    high = shape.schema.get("maximum", shape.schema.get("exclusiveMaximum"))
    return "" if low is None or high is None else other_unit(field, got, low, high)


def _cure_of_text(field: str, text: str) -> str:
    """Return what to write instead of a text that was meant as a number."""
    if re.fullmatch(r"\s*[-+]?[0-9]+,[0-9]+\s*", text):
        return "write decimals with a point, " + text.strip().replace(",", ".")
    if re.fullmatch(r"[0-9]{1,3}([_' ][0-9]{3})+", text):
        return "write the digits without separators, " + re.sub(r"[_' ]", "", text)
    match = _NUMBER_AND_UNIT.fullmatch(text)
    try:
        number = float(match[1]) if match else None
    except ValueError:
        number = None
    if not match or number is None:
        return ""
    if not match[2]:
        return f"write the number without quotes or leading zeros, {number:.12g}"
    ending, factor = _UNITS.get(match[2], ("", 0.0))
    if ending and field.lower().endswith(f"_{ending.lower()}"):
        return f"write the number alone, in the unit of the field's name: {number * factor:.12g}"
    return "write the number alone, in the unit of the field's name"
