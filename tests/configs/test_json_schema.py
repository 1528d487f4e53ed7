"""The printed JSON Schema against the shipped files and against damaged ones, by a validator of its own."""

import json
import re
from functools import cache
from pathlib import Path
from typing import Any

import pytest

import configs
from configs.validation.json_schema import scenario_json_schema
from symolo.core.yaml.reader import read_yaml

SHIPPED = Path(configs.__file__).parent
TYPES: dict[str, tuple[type, ...]] = {
    "null": (type(None),),
    "object": (dict,),
    "array": (list,),
    "string": (str,),
    "boolean": (bool,),
    "number": (int, float),
    "integer": (int,),
}


@cache
def printed_schema() -> dict[str, Any]:
    return scenario_json_schema()


def faults(value: Any, schema: dict[str, Any], path: str = "") -> list[str]:
    """Paths at which a value breaks the keywords of JSON Schema 2020-12 that are in use here."""
    if "$ref" in schema:
        return faults(value, printed_schema()["$defs"][schema["$ref"].removeprefix("#/$defs/")], path)
    found = [] if _keywords_hold(value, schema) else [path]
    for several in ("anyOf", "oneOf"):
        if several in schema:
            count = sum(not faults(value, option, path) for option in schema[several])
            found += [path] if count == 0 or (several == "oneOf" and count > 1) else []
    if isinstance(value, dict):
        for key, item in value.items():
            if key in schema.get("properties", {}):
                found += faults(item, schema["properties"][key], f"{path}.{key}")
            elif schema.get("additionalProperties") is False:
                found.append(f"{path}.{key}")
    if isinstance(value, list):
        items = schema.get("prefixItems", []) + [schema.get("items", {})] * len(value)
        found += [fault for n, item in enumerate(value) for fault in faults(item, items[n], f"{path}.{n}")]
    return found


def _keywords_hold(value: Any, schema: dict[str, Any]) -> bool:
    types = schema.get("type", list(TYPES))
    known = [kind for name in ([types] if isinstance(types, str) else types) for kind in TYPES[name]]
    if type(value) not in known:
        return False
    if "enum" in schema and value not in schema["enum"]:
        return False
    if "const" in schema and value != schema["const"]:
        return False
    if isinstance(value, str) and not re.search(schema.get("pattern", ""), value):
        return False
    if isinstance(value, list):
        return schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value))
    if isinstance(value, dict):
        return set(schema.get("required", [])) <= set(value)
    if isinstance(value, int | float):
        above = schema.get("exclusiveMinimum", -float("inf")) < value < schema.get("exclusiveMaximum", float("inf"))
        return above and schema.get("minimum", value) <= value <= schema.get("maximum", value)
    return True


@pytest.mark.parametrize("path", sorted((SHIPPED / "scenarios").glob("*.yaml")), ids=lambda path: path.stem)
def test_shipped_scenarios_follow_the_schema(path: Path):
    assert faults(read_yaml(path).root.plain(), printed_schema()) == []


@pytest.mark.parametrize(
    ("kind", "name"), [("arenas", "ArenaConfig"), ("robots", "RobotConfig"), ("looks", "LookConfig")]
)
def test_shipped_sections_follow_their_definition(kind: str, name: str):
    paths = sorted((SHIPPED / kind).glob("*.yaml"))
    assert paths
    for path in paths:
        assert faults(read_yaml(path).root.plain(), printed_schema()["$defs"][name]) == []


START = {"x_m": 0.5, "y_m": 0, "yaw_deg": 90}
WALL = {"name": "A", "start": [0, 0], "end": [1, 0]}
GOOD: dict[str, Any] = {
    "name": "trial",
    "routes": [{"name": "CW", "start": START}],
    "arena": "symolo",
    "robot": {"extends": "nominal", "motor": {"winding_resistance_ohm": {"uniform": [2, 3]}}},
    "look": "./looks/mine.yaml",
}


@pytest.mark.parametrize(
    "change",
    [
        {},
        {"robot": {"extends": "nominal", "tof": {"rays": {"choice": [60, 90]}}}},
        {"robot": {"extends": "nominal", "drive": {"track_m": {"normal": {"mean": 0.14, "sd": 0.001, "low": 0.1}}}}},
        {"routes": [{"name": "CW", "start": {**START, "x_m": {"log_uniform": [0.5, 0.6]}}}]},
        {"arena": {"extends": "symolo", "obstacles": [{"name": "A", "center": [{"uniform": [0, 1]}, 0]}]}},
        {"routes": [{"name": "CW", "start": START, "arena": "./rooms/a.yaml"}]},
        {"routes": [{"name": "CW", "start": START, "arena": {"extends": "hall", "obstacles": []}}]},
        {"look": {"extends": "lab", "assets": "photos", "floor": {"image": {"file": {"choice": ["a.png", "b.jpg"]}}}}},
        {"look": {"extends": "lab", "assets": "photos", "sky": {"panorama": "hall.hdr"}}},
        {"look": {"extends": "lab", "assets": "photos", "sky": {"panorama": {"choice": ["city", "hall.hdr"]}}}},
        {
            "arena": {
                "extends": "symolo",
                "obstacles": [{"name": "A", "center": [0, 0], "surface": {"choice": ["wood"]}}],
            }
        },
    ],
)
def test_what_the_loader_takes_follows_the_schema(change: dict[str, Any]):
    assert faults({**GOOD, **change}, printed_schema()) == []


@pytest.mark.parametrize(
    ("change", "place"),
    [
        ({"sed": 3}, ".sed"),
        ({"seed": {"uniform": [1, 2]}}, ".seed"),
        ({"name": {"choice": ["a", "b"]}}, ".name"),
        ({"arena": "symlo"}, ".arena"),
        ({"routes": [{"name": "CW"}]}, ".routes.0"),
        ({"routes": [{"name": "CW", "start": START, "arena": "symlo"}]}, ".routes.0.arena"),
        ({"stop": {"lap": {"choice": [True, False]}}}, ".stop.lap"),
        ({"rates": {"camera_hz": {"choice": [5, 10]}}}, ".rates.camera_hz"),
        ({"render": {"samples": {"uniform": [1]}}}, ".render.samples"),
        ({"render": {"samples": 0}}, ".render.samples"),
        ({"render": {"denoise": {"uniform": [0, 1]}}}, ".render.denoise"),
        ({"robot": {"extends": "nominal", "motor": {"winding_resistance_ohm": 0}}}, ".robot"),
        ({"arena": {"extends": "symolo", "obstacles": [{"name": "A"}]}}, ".arena"),
        ({"look": {"extends": "lab", "assets": ["photos"]}}, ".look"),
        ({"look": {"extends": "lab", "sky": {"panorama": 3}}}, ".look"),
    ],
)
def test_what_the_loader_refuses_breaks_the_schema_there(change: dict[str, Any], place: str):
    assert set(faults({**GOOD, **change}, printed_schema())) == {place}


def test_a_scenario_that_extends_nothing_must_be_whole():
    assert faults({"name": "trial"}, printed_schema()) == [""]
    assert faults({"name": "trial", "extends": "smoke"}, printed_schema()) == []


def test_the_schema_is_plain_json():
    assert json.loads(json.dumps(printed_schema(), allow_nan=False)) == printed_schema()
