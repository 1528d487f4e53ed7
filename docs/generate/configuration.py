"""Every key of a scenario file with its meaning, allowed values and default, from the JSON Schema."""

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml
from markdown_text import anchor, page, table, text

from configs.references import SECTIONS, shipped_names
from configs.schema.base import FIXED_KEY
from configs.validation.json_schema import scenario_json_schema

ABOUT = """This page lists every setting of a scenario with its bounds and its default. The default acts only if no file
sets a value; the shipped looks, robots, arenas and scenarios (`configs/`) set many values. Units are in the names.
Write a key below its section in a file, `render: {width_px: 320}`, or on the command line, `--set render.width_px=320`.
For a setting that is marked *fixed*, no [distribution](../scenarios.md#distributions) is allowed. If the heading of a
section is not a path, the section is allowed wherever a key links to it."""

ROBOTS = Path(__file__).parents[2] / "configs" / "robots"

OTHER_KEY = "NAME"
"""Key that stands for a name that users choose."""
OFTEN = 3
"""Largest number of paths that a heading lists; a section with more paths has its name as the heading."""


@dataclass
class _Section:
    name: str
    schema: Mapping[str, Any]
    paths: list[str] = field(default_factory=list)

    @property
    def heading(self) -> str:
        if not self.paths[0] or len(self.paths) > OFTEN:
            return self.name
        kind = self.schema["properties"].get("kind", {}).get("const")
        return " / ".join(self.paths) + (f" of kind {kind}" if kind else "")


def configuration() -> str:
    schema = scenario_json_schema()
    definitions = {**schema["$defs"], "Scenario": {key: value for key, value in schema.items() if key != "$defs"}}
    sections = _sections(definitions)
    return page(
        "Settings", ABOUT, (part for section in sections.values() for part in _section_parts(section, sections))
    )


def _sections(definitions: Mapping[str, Any]) -> dict[str, _Section]:
    """Return the sections in the order of a scenario, each with all paths that lead to it."""
    sections: dict[str, _Section] = {}

    def walk(name: str, path: str, within: tuple[str, ...]) -> None:
        if name == "RobotEffects" or name in within:
            return  # docs/reference/effects.md lists the effects
        section = sections.setdefault(name, _Section(name, definitions[name]))
        section.paths.append(path)
        for key, value in section.schema.get("properties", {}).items():
            listed = "items" in value
            for inner in _referred(value):
                walk(inner, f"{path}.{key}".lstrip(".") + ("[]" if listed else ""), (*within, name))
        for inner in _referred(_other_keys(section.schema)):
            if inner not in sections:  # a kind that is no key
                walk(inner, f"{path}.{OTHER_KEY}", (*within, name))

    walk("Scenario", "", ())
    return sections


def _other_keys(schema: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the schema of the keys that users choose themselves; empty for a section without such keys."""
    others = schema.get("additionalProperties")
    return others if isinstance(others, dict) else {}


def _referred(schema: Mapping[str, Any]) -> Iterator[str]:
    """Yield the names of the sections that a field may contain."""
    if "$ref" in schema:
        name = schema["$ref"].rsplit("/", 1)[1]
        if not name.endswith("_distribution"):
            yield name
    for key in ("anyOf", "oneOf", "prefixItems"):
        for inner in schema.get(key, ()):
            yield from _referred(inner)
    if isinstance(schema.get("items"), dict):
        yield from _referred(schema["items"])


def _section_parts(section: _Section, sections: Mapping[str, _Section]) -> Iterator[str]:
    yield f"## {section.heading}"
    if section.schema.get("description"):
        yield text(section.schema["description"])
    needed = section.schema.get("required", ())
    rows = []
    for key, value in section.schema.get("properties", {}).items():
        default = "required" if key in needed else _default(value, sections) or _nominal(section.paths, key)
        rows.append((f"`{key}`", text(_meaning(value, sections)), _allowed(key, value, sections), default))
    if others := _other_keys(section.schema):
        rows.append((f"`{OTHER_KEY}`", "any other name", _value(others, sections), ""))
    yield table(("key", "meaning", "allowed values", "default"), rows)


def _meaning(schema: Mapping[str, Any], sections: Mapping[str, _Section]) -> str:
    """Return the description of a field; without one, the first paragraph of the description of its section."""
    described = (sections[name].schema.get("description", "") for name in _referred(schema) if name in sections)
    return schema.get("description") or next(described, "").split("\n\n")[0]


def _default(schema: Mapping[str, Any], sections: Mapping[str, _Section]) -> str:
    """Return the default as text; empty for a section whose table contains the same values as defaults."""
    default = schema.get("default")
    if default is None or default == "":
        return ""
    if isinstance(default, dict):
        defaults = {key: value.get("default") for name in _referred(schema) for key, value in _fields(name, sections)}
        return "" if default.items() <= defaults.items() else f"`{_flow(default)}`"
    return f"`{json.dumps(default)}`" if not isinstance(default, str) else f"`{default}`"


def _fields(name: str, sections: Mapping[str, _Section]) -> Iterable[tuple[str, Mapping[str, Any]]]:
    return sections[name].schema["properties"].items() if name in sections else ()


def _flow(value: object) -> str:
    """Return a default as one writes it in a file."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_flow(inner)}" for key, inner in value.items()) + "}"
    return json.dumps(value)


def _nominal(paths: list[str], key: str) -> str:
    """Return the value of the shipped robot `nominal`, for a setting that has no default and only one path."""
    section, *names = (*paths[0].split("."), key)
    if len(paths) > 1 or section != "robot":
        return ""
    value = yaml.safe_load((ROBOTS / "nominal.yaml").read_text(encoding="utf-8"))
    for name in names:
        value = value.get(name) if isinstance(value, dict) else None
    return "" if value is None or isinstance(value, (dict, str)) else f"`{json.dumps(value)}` in `nominal`"


def _allowed(key: str, schema: Mapping[str, Any], sections: Mapping[str, _Section]) -> str:
    if key == "effects":
        return "[effects](effects.md)"
    if key in SECTIONS:
        section = next(_referred(schema))
        return f"{', '.join(shipped_names(key))}, a path, or {_link(section, sections)}"
    what = _value(schema, sections)
    return f"{what}; *fixed*" if FIXED_KEY in schema else what


def _value(schema: Mapping[str, Any], sections: Mapping[str, _Section]) -> str:
    if "$ref" in schema:
        return _link(schema["$ref"].rsplit("/", 1)[1], sections)
    if "prefixItems" in schema:
        return "[" + ", ".join(_value(item, sections) for item in schema["prefixItems"]) + "]"
    if "items" in schema:
        return f"a list of: {_value(schema['items'], sections)}"
    choices = [inner for key in ("anyOf", "oneOf") for inner in schema.get(key, ())]
    if choices:
        values = [_value(inner, sections) for inner in choices]
        return ", ".join(dict.fromkeys(value for value in values if value))
    return _leaf(schema)


def _leaf(schema: Mapping[str, Any]) -> str:
    if "enum" in schema:
        return ", ".join(f"`{option}`" for option in schema["enum"])
    if "const" in schema:
        return f"`{schema['const']}`"
    low = _bound(schema, "minimum", "exclusiveMinimum", ("at least", "above"))
    high = _bound(schema, "maximum", "exclusiveMaximum", ("at most", "below"))
    if "minimum" in schema and "maximum" in schema:
        return f"{_number(schema['minimum'])} ... {_number(schema['maximum'])}"
    kind = {"null": "null", "boolean": "true, false", "string": "text", "integer": "whole number", "number": "number"}
    return " ".join(word for word in (kind.get(schema.get("type", ""), ""), low, high) if word)


def _bound(schema: Mapping[str, Any], inclusive: str, exclusive: str, words: tuple[str, str]) -> str:
    for key, word in zip((inclusive, exclusive), words, strict=True):
        if key in schema:
            return f"{word} {_number(schema[key])}"
    return ""


def _number(value: float) -> str:
    return str(value) if isinstance(value, int) else f"{value:.12g}"


def _link(name: str, sections: Mapping[str, _Section]) -> str:
    """Return a link to a section; empty for a distribution, which is allowed for every setting that is not fixed."""
    if name.endswith("_distribution"):
        return ""
    section = sections[name]
    # Where two classes have one name, the schema puts their modules before it.
    return f"[{name.rpartition('__')[2]}]({anchor(section.heading)})"
