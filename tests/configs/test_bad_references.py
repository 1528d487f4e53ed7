"""Overrides, names and files that cannot be used: each is refused in one line that says which."""

from pathlib import Path

import pytest

from configs.loader import load_scenario, load_section
from symolo.core.errors import InputError

OVERRIDES = {
    "no value": ("seed", "--set: got 'seed', allowed: field.path=value"),
    "no path": ("=3", "--set: got '=3', allowed: field.path=value"),
    "gap in the path": ("look..sun=3", "--set: got 'look..sun=3'"),
    "path without end": (".".join("a" * 5000) + "=1", "--set: got 'a.a.a.a."),
    "index of no end": (f"routes.{'9' * 5000}.runs=1", "--set routes.999"),
    "empty value": ("seed=", "--set seed: got nothing (null), allowed: whole number"),
    "text for a number": ("seed=abc", "--set seed: got 'abc', allowed: whole number"),
    "unknown field": (
        "look.sun.elevatoin_deg=30",
        "--set look.sun.elevatoin_deg: unknown key; allowed: elevation_deg",
    ),
    "unknown section": ("lok.sun.elevation_deg=30", "--set lok.sun.elevation_deg: lok: unknown key"),
    "out of bounds": (
        "look.sun.elevation_deg=95",
        "--set look.sun.elevation_deg: got 95, allowed: number >= 1 and <= 90",
    ),
    "distribution out of bounds": (
        "look.sun.elevation_deg={uniform: [0, 30]}",
        "--set look.sun.elevation_deg: got 0.0",
    ),
    "broken YAML": ("seed=[", "--set seed: not valid YAML"),
    "index beyond the list": (
        "routes.2.runs=1",
        "--set routes.2.runs: routes: item: got '2', allowed: an index from 0",
    ),
    "unknown item": ("routes.CWW.runs=1", "--set routes.CWW.runs: routes: item: got 'CWW'"),
    "field of a number": ("seed.low=1", "--set seed.low: seed is a single value and has no field 'low': got 7"),
    "unknown look": ("look=clasroom", "--set look: got 'clasroom'"),
    "several arenas": (
        "arena={choice: [symolo, classroom]}",
        "--set arena: one arena for all runs, which no distribution draws: got {choice: ['symolo', 'classroom']}",
    ),
    "several looks": ("look={choice: [lab, night]}", "--set look: one look for all runs"),
    "extends": ("extends=smoke", "--set extends: 'extends' is read from files alone"),
    "tag": ("seed=!!int 3", "--set seed: value: got '!!int'; tags are not read"),
}


@pytest.mark.parametrize(("override", "expected"), OVERRIDES.values(), ids=OVERRIDES.keys())
@pytest.mark.usefixtures("here")
def test_a_bad_override_is_refused_in_one_line_that_quotes_it(override: str, expected: str):
    with pytest.raises(InputError) as caught:
        load_scenario("trial.yaml", [override])
    assert str(caught.value).startswith(expected)
    assert len(str(caught.value).splitlines()) == 1


FILES = {
    "empty": (b"", "bad.yaml: the file is empty; allowed: a mapping"),
    "comments alone": (b"# nothing\n", "bad.yaml: the file is empty; allowed: a mapping"),
    "list at the top": (b"- a\n- b\n", "bad.yaml:1: top level is a list; allowed: a mapping"),
    "text at the top": (b"\nhello\n", "bad.yaml:2: top level is a single value; allowed: a mapping"),
    "Latin-1": (b"name: a\ndescription: caf\xe9\n", "bad.yaml:2: the file is not UTF-8; save it as UTF-8"),
    "UTF-16": ("name: a\n".encode("utf-16"), "bad.yaml:1: the file is not UTF-8"),
    "zero byte": (b"name: a\nseed: \0\n", "bad.yaml:2: character '\\x00' is not allowed in YAML"),
    "too large": (b"#" * (1 << 20) + b"\n", "bad.yaml: the file is too large; allowed: at most 1048576 bytes"),
    "too many values": (b"a: [" + b"x, " * 30_000 + b"]\n", "bad.yaml:1: too many values; allowed: at most 20000"),
}


@pytest.mark.parametrize(("content", "expected"), FILES.values(), ids=FILES.keys())
def test_a_file_that_is_no_yaml_mapping_is_refused(content: bytes, expected: str, here: Path):
    (here / "bad.yaml").write_bytes(content)
    with pytest.raises(InputError) as caught:
        load_scenario("bad.yaml")
    assert str(caught.value).startswith(expected)
    assert len(str(caught.value).splitlines()) == 1


NAMES = {
    "unknown name": ("smok", "scenario: got 'smok', allowed: the name of a shipped scenario", "did you mean smoke"),
    "missing file": ("trail.yaml", "scenario: no such file: got 'trail.yaml'", "did you mean trial.yaml"),
    "missing folder": ("none/trial.yaml", "scenario: no such file: got 'none/trial.yaml'", "a YAML file"),
    "shipped name with an ending": ("smoke.yaml", "scenario: no such file: got 'smoke.yaml'", "did you mean smoke"),
    "name of a file beside": ("trial", "scenario: got 'trial'", "did you mean ./trial.yaml"),
    "folder": ("./", "scenario: a folder, not a file", "a YAML file"),
    "nothing": ("", "scenario: got ''", "the path of a YAML file"),
    "name too long for the system": ("x" * 300 + ".yaml", "scenario: no such file: got 'xxx", "a YAML file"),
    "zero byte": ("a\0.yaml", "scenario: no such file: got 'a\\x00.yaml'", "a YAML file"),
    "device": ("/dev/zero", "scenario: no such file: got '/dev/zero'", "a YAML file"),
}


@pytest.mark.parametrize(("name", "expected", "telling"), NAMES.values(), ids=NAMES.keys())
@pytest.mark.usefixtures("here")
def test_a_scenario_that_is_not_there_is_refused(name: str, expected: str, telling: str):
    with pytest.raises(InputError) as caught:
        load_scenario(name)
    assert str(caught.value).startswith(expected)
    assert telling in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1


def test_a_fault_below_extends_names_the_file_that_holds_it(here: Path):
    (here / "base.yaml").write_text("extends: trial.yaml\n\nstop: {time_limit_s: -1}\n")
    (here / "top.yaml").write_text("extends: base.yaml\nseed: 3\n")
    with pytest.raises(InputError, match=r"^base\.yaml:3: stop\.time_limit_s: got -1"):
        load_scenario("top.yaml")


def test_a_fault_in_a_section_file_names_that_file(here: Path):
    (here / "looks").mkdir()
    (here / "looks" / "low.yaml").write_text("extends: classroom\nsun:\n  elevation_deg: 0\n")
    (here / "top.yaml").write_text("extends: trial.yaml\nlook: looks/low.yaml\n")
    with pytest.raises(InputError, match=r"^looks/low\.yaml:3: look\.sun\.elevation_deg: got 0, allowed"):
        load_scenario("top.yaml")


def test_files_that_extend_each_other_are_listed_in_their_order(here: Path):
    (here / "a.yaml").write_text("extends: b.yaml\n")
    (here / "b.yaml").write_text("name: b\nextends: a.yaml\n")
    with pytest.raises(InputError, match=r"^b\.yaml:2: extends: .*a\.yaml -> b\.yaml -> a\.yaml"):
        load_scenario("a.yaml")


def test_a_tower_of_files_is_refused(here: Path):
    for number in range(200):
        (here / f"{number}.yaml").write_text(f"extends: {number + 1}.yaml\n")
    with pytest.raises(InputError, match="extends: too many files extend each other; allowed: 32"):
        load_scenario("0.yaml")


def test_a_section_alone_is_refused_with_the_same_words(here: Path):
    (here / "low.yaml").write_text("extends: classroom\nsun: {elevation_deg: 0}\n")
    with pytest.raises(
        InputError, match=r"^low\.yaml:2: look\.sun\.elevation_deg: got 0, allowed: number >= 1 and <= 90"
    ):
        load_section("look", "low.yaml")
    with pytest.raises(InputError, match=r"^--look: got 'clasroom', .*did you mean classroom"):
        load_section("look", "clasroom")


def test_nothing_is_written_by_a_refusal(here: Path):
    (here / "bad.yaml").write_text("name: 3\n")
    before = sorted(here.rglob("*"))
    with pytest.raises(InputError):
        load_scenario("bad.yaml")
    assert sorted(here.rglob("*")) == before
