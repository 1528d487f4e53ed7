"""Whatever a damaged scenario holds, it is read, or refused by an InputError with one line for each fault, and soon."""

import random
import time
from copy import deepcopy
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from configs.draw import draw_run
from configs.loader import load_scenario
from symolo.core.errors import FaultsError, InputError

PASSAGES = [
    "nan", ".nan", "1e999", "-1", "0", "''", "'1'", "null", "true", "~", "[]", "{}", "[", "}", ": ", "\t", "\n", "- ",
    "&a x", "*a", "!!python/name:os", "---", "...", "%YAML 3.0", "? ", "<<: {}", "#", '"', "|", ">", "@", "`", "\x00",
    "\u2028", "é", "\U0001f916", "9" * 400, "{uniform: [2, 1]}", "{uniform: [0, 1]}", "{choice: []}",
    "{normal: [0, 1]}", "{normal: {mean: 0}}", "{log_uniform: [0, 1]}", "extends: smoke", "extends: ./scenario.yaml",
]  # fmt: skip
VALUES: list[Any] = [
    None, True, -1, 0, 1e300, 10**30, "", "abc", "1", "symolo", "../x.yaml", [], [1, [2, [3]]], {}, {"a": 1},
    {"uniform": 1},
    {"uniform": [0, 1]}, {"uniform": [1, 0]}, {"uniform": [0, 1], "a": 1}, {"normal": [0.5, 0.01]}, {"normal": []},
    {"normal": {"mean": 1e308, "sd": 1e308}}, {"log_uniform": [1e-300, 1e300]}, {"choice": [0, "a", True]},
    {"choice": [None]}, {"extends": "smoke"}, {"extends": 3}, {"kind": "arc"}, {"kind": ["arc"]}, {"name": "A"}, 0.5, 1,
]  # fmt: skip

SCENARIO: dict[str, Any] = load_scenario("symolo").tree
TEXT = yaml.safe_dump(SCENARIO, sort_keys=False)


def _paths(value: object, path: tuple[str | int, ...] = ()) -> list[tuple[str | int, ...]]:
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [path, *(found for key, item in inner for found in _paths(item, (*path, key)))]


PATHS = _paths(SCENARIO)[1:]


def _read_or_refused(content: bytes) -> None:
    """Within a second of processor time, for other work on the machine is none of it."""
    Path("scenario.yaml").write_bytes(content)
    messages: list[str] = []
    start = time.process_time()
    try:
        loaded = load_scenario("scenario.yaml")
        draw_run(loaded, loaded.routes[0].name, 1)
    except InputError as error:
        faults = error.faults if isinstance(error, FaultsError) else (error,)
        messages = [str(fault) for fault in faults]
    assert time.process_time() - start < 1.0
    assert all(len(message.splitlines()) == 1 and len(message) < 1000 for message in messages)


@pytest.mark.usefixtures("here")
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(st.tuples(st.floats(0, 1), st.integers(0, 60), st.sampled_from(PASSAGES)), min_size=1, max_size=3))
def test_damaged_text_is_read_or_refused(cuts: list[tuple[float, int, str]]):
    text = TEXT
    for place, length, passage in cuts:
        at = int(place * len(text))
        text = text[:at] + passage + text[at + length :]
    _read_or_refused(text.encode())


@pytest.mark.usefixtures("here")
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(st.tuples(st.sampled_from(PATHS), st.sampled_from(VALUES)), min_size=1, max_size=3))
def test_a_wrong_value_at_any_field_is_read_or_refused(changes: list[tuple[tuple[str | int, ...], Any]]):
    tree = deepcopy(SCENARIO)
    for path, value in changes:
        _put(tree, path, value)
    _read_or_refused(_written(tree))


def _written(tree: object) -> bytes:
    """Text that libyaml writes, which is ten times as fast as Python."""
    return yaml.dump(tree, Dumper=yaml.CSafeDumper, sort_keys=False, default_flow_style=True).encode()


def _put(tree: Any, path: tuple[str | int, ...], value: object) -> None:
    for key in path[:-1]:
        if not isinstance(tree, dict | list) or (isinstance(tree, dict) and key not in tree):
            return  # an earlier change has removed the way
        if isinstance(tree, list) and not (isinstance(key, int) and key < len(tree)):
            return
        tree = tree[key]
    if isinstance(tree, dict) or (isinstance(tree, list) and isinstance(path[-1], int) and path[-1] < len(tree)):
        tree[path[-1]] = value


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.binary(max_size=200))
@pytest.mark.usefixtures("here")
def test_any_bytes_are_read_or_refused(content: bytes):
    _read_or_refused(content)


def _mutated(rng: random.Random) -> bytes:
    """A shipped scenario with one to four changes: of passages, of values, or of bytes."""
    if rng.random() < 0.4:
        tree = deepcopy(SCENARIO)
        for _ in range(rng.randint(1, 4)):
            _put(tree, rng.choice(PATHS), rng.choice(VALUES))
        return _written(tree)
    data = TEXT.encode()
    for _ in range(rng.randint(1, 4)):
        at, length = rng.randrange(len(data)), rng.choice((0, 0, 1, 5, 60, 600))
        new = rng.choice(PASSAGES).encode() if rng.random() < 0.7 else rng.randbytes(rng.randint(1, 8))
        data = data[:at] + new + data[at + length :]
    return data


@pytest.mark.faults
@pytest.mark.parametrize("part", range(100))
@pytest.mark.usefixtures("here")
def test_a_thousand_mutated_scenarios(part: int):
    """A hundred times a thousand: each is read or refused within a second, and nothing else is written."""
    rng = random.Random(part)  # noqa: S311 - mutations, not secrets
    there = {*Path().iterdir(), Path("scenario.yaml")}
    for _ in range(1000):
        _read_or_refused(_mutated(rng))
    assert set(Path().iterdir()) == there
