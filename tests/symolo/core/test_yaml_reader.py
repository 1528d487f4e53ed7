from pathlib import Path

import pytest

import configs
from symolo.core.errors import InputError
from symolo.core.yaml.reader import parse_yaml, read_yaml


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e5", 1e5),
        ("1e-3", 0.001),
        ("-.5", -0.5),
        ("1.", 1.0),
        ("+7", 7),
        ("-0", 0),
        ("true", True),
        ("False", False),
        ("~", None),
        ("null", None),
        # YAML 1.1 would make true, false, eight, sixty-one and a date of these
        ("yes", "yes"),
        ("off", "off"),
        ("010", "010"),
        ("1:01", "1:01"),
        ("2024-01-01", "2024-01-01"),
        ("1_000", "1_000"),
        ("0x10", "0x10"),
        ("'15'", "15"),
        ('"true"', "true"),
        (".", "."),
        ("e5", "e5"),
    ],
)
def test_scalars_are_those_of_yaml_1_2(text: str, value: object):
    scalar = parse_yaml(f"key: {text}", "file").plain()["key"]
    assert scalar == value
    assert type(scalar) is type(value)


def test_every_node_knows_its_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    Path("a.yaml").write_text("# head\nmotor:\n  resistance: 3\nwalls:\n  - name: A\n    start: [0,\n      1]\n")
    root = read_yaml(Path("a.yaml")).root
    places = {path: node.where for path, node in root.walk()}
    assert places["motor",] == "a.yaml:2"
    assert places["motor", "resistance"] == "a.yaml:3"
    assert places["walls", 0] == "a.yaml:5"
    assert places["walls", 0, "start"] == "a.yaml:6"
    assert places["walls", 0, "start", 1] == "a.yaml:7"


def test_files_outside_the_working_directory_are_named_in_full(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    (tmp_path / "inner").mkdir()
    (tmp_path / "a.yaml").write_text("a: 1\n")
    monkeypatch.chdir(tmp_path / "inner")
    assert read_yaml(Path("../a.yaml").resolve()).root.where == f"{tmp_path}/a.yaml:1"


@pytest.mark.parametrize("start", [b"\xef\xbb\xbf", b""])
@pytest.mark.parametrize("end", [b"\n", b"\r\n"])
def test_byte_order_mark_and_windows_line_ends_change_nothing(start: bytes, end: bytes, tmp_path: Path):
    path = tmp_path / "a.yaml"
    path.write_bytes(start + end.join([b"a: 1", b"b: {c: two}", b""]))
    document = read_yaml(path)
    assert document.root.plain() == {"a": 1, "b": {"c": "two"}}
    assert document.root.place_of(("b",)) == f"{path}:2"


def test_32_levels_are_read():
    parse_yaml("a: " + "[" * 32 + "]" * 32, "file")


@pytest.mark.parametrize("depth", [33, 5000])
def test_more_levels_are_refused(depth: int):
    with pytest.raises(InputError, match="nested too deep; allowed: 32 levels"):
        parse_yaml("a: " + "[" * depth + "]" * depth, "file")


def test_a_message_has_no_control_characters_of_the_file():
    with pytest.raises(InputError) as caught:
        parse_yaml('"a\\x1b[31m\\nb": 1\n"a\\x1b[31m\\nb": 2\n', "file")
    assert str(caught.value) == "file:2: a [31m b: the key is given twice, first at file:1; keep one of the two"


def test_what_is_no_file_is_refused(tmp_path: Path):
    with pytest.raises(InputError, match="this is a folder; allowed: a YAML file"):
        read_yaml(tmp_path)
    with pytest.raises(InputError, match="there is no such file"):
        read_yaml(tmp_path / "none.yaml")


@pytest.mark.parametrize("text", ["a: 'x", "a:\n\tb: 1", "a: [1, 2", "a: *b", "a: \x01", "- 1\n- b: 2: 3"])
def test_with_and_without_libyaml_the_same_is_refused_in_the_same_words(text, monkeypatch):
    with pytest.raises(InputError) as by_libyaml:
        parse_yaml(text, "file")
    monkeypatch.setattr("yaml.__with_libyaml__", False)
    with pytest.raises(InputError) as without:
        parse_yaml(text, "file")
    assert str(by_libyaml.value) == str(without.value)


def test_with_and_without_libyaml_the_same_is_read(monkeypatch):
    texts = [path.read_text() for path in sorted(Path(configs.__file__).parent.rglob("*.yaml"))]
    by_libyaml = [parse_yaml(text, "file") for text in texts]
    monkeypatch.setattr("yaml.__with_libyaml__", False)
    assert [parse_yaml(text, "file") for text in texts] == by_libyaml
