"""What holds for every arena, robot, look and scenario that is shipped, and for every field of the schema."""

from itertools import cycle
from pathlib import Path
from typing import Any

import pytest

import configs
from configs.draw import draw_all, draw_arena, draw_look, draw_robot
from configs.loader import load_scenario, load_section
from configs.references import FOLDERS, SECTIONS, shipped_names
from configs.schema.scenario import RunSpec, Scenario
from symolo.core.errors import FaultsError, InputError
from symolo.core.yaml.reader import read_yaml
from symolo.core.yaml.tree import DISTRIBUTION_KINDS

SHIPPED = Path(configs.__file__).parent
FILES = sorted(path for folder in FOLDERS.values() for path in (SHIPPED / folder).iterdir() if path.is_file())
TOO_LARGE = {
    ("micromouse", "scout"): "would start inside obstacle O2",
    ("random_arenas", "scout"): r"beside_m: too little room: .* `arena: \{extends: random, scale: 1\.95\}`",
    ("scout", "random"): r"beside_m: too little room: .* `arena: \{extends: random, scale: 1\.95\}`",
}
"""Scenarios with robots or arenas in which the robot, at 35 cm, does not fit between the obstacles, and why."""
MEMBERS = [(kind, name) for kind in SECTIONS for name in shipped_names(kind)]
OTHERS = [member for member in MEMBERS if member[0] != "look"]
COMBINATIONS = [(*other, look) for other, look in zip(OTHERS, cycle(shipped_names("look")))]
"""Each arena and each robot with one of the looks, so that each look is in one of them at least."""
PAIRS = [
    pytest.param(
        scenario,
        *combination,
        marks=() if (i + j) % 3 == 0 or (scenario, combination[1]) in TOO_LARGE else pytest.mark.long,
    )
    for i, scenario in enumerate(shipped_names("scenario"))
    for j, combination in enumerate(COMBINATIONS)
]
"""By default each section in every third scenario, and each scenario with every third section."""
DRAW = {"arena": draw_arena, "robot": draw_robot, "look": draw_look}


def test_every_kind_is_shipped():
    assert {path.parent.name for path in FILES} == set(FOLDERS.values())
    assert {look for *_, look in COMBINATIONS} == set(shipped_names("look"))


@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_a_shipped_file_bears_its_name_and_says_what_it_is(path: Path):
    root = read_yaml(path).root.plain()
    assert path.suffix == ".yaml"
    assert root["name"] == path.stem
    assert root["description"]


@pytest.mark.parametrize(("kind", "name"), MEMBERS)
def test_a_shipped_section_loads_and_draws(kind: str, name: str):
    section = load_section(kind, name)
    for run in range(1, 6):
        config, drawn = DRAW[kind](section, 1, "CW", run)
        assert config.name == name
        assert len(drawn) == len(section.distributions)


@pytest.mark.parametrize("name", shipped_names("scenario"))
def test_a_shipped_scenario_loads_and_draws_the_same_bytes_twice(name: str):
    texts = [[spec.model_dump_json() for spec in draw_all(load_scenario(name))] for _ in range(2)]
    assert texts[0] == texts[1]
    assert len(texts[0]) == sum(route.runs for route in load_scenario(name).routes)
    for text in texts[0]:
        assert RunSpec.model_validate_json(text).model_dump_json() == text


@pytest.mark.parametrize(("scenario", "kind", "name", "look"), PAIRS)
def test_every_section_goes_with_every_scenario(scenario: str, kind: str, name: str, look: str):
    settings = [f"{kind}={name}", f"look={look}"]
    if (scenario, name) in TOO_LARGE:
        with pytest.raises((InputError, FaultsError), match=TOO_LARGE[scenario, name]):
            draw_all(load_scenario(scenario, settings))
        return
    specs = draw_all(load_scenario(scenario, settings))
    assert {(getattr(spec, kind).name, spec.look.name) for spec in specs} == {(name, look)}


def test_no_field_is_named_like_a_distribution():
    """A mapping with such a key is read as a distribution wherever it stands."""
    names = set(_field_names(Scenario.model_json_schema()))
    assert "elevation_deg" in names
    assert not names & {*DISTRIBUTION_KINDS, "extends"}


def _field_names(schema: Any) -> list[str]:
    if isinstance(schema, list):
        return [name for item in schema for name in _field_names(item)]
    if not isinstance(schema, dict):
        return []
    return [*schema.get("properties", {}), *(name for item in schema.values() for name in _field_names(item))]


def test_every_number_has_bounds():
    """A number without them would let a slip of the keyboard through to an engine."""
    definitions = Scenario.model_json_schema()["$defs"].values()
    fields = {(d["title"], name): f for d in definitions for name, f in d.get("properties", {}).items()}
    numbers = {key: f for key, f in fields.items() if f.get("type") in {"number", "integer"} and "const" not in f}
    assert len(numbers) > 100
    for key, field in numbers.items():
        assert {"minimum", "exclusiveMinimum"} & set(field), key
        assert {"maximum", "exclusiveMaximum"} & set(field), key
