"""What holds for every exporter: it is held against random releases, and its bytes are the same again."""

import ast
from pathlib import Path

import pytest

from symolo.exporters import FORMATS

HERE = Path(__file__).parent


def formats_of(path: Path) -> set[str]:
    """Texts in tests of a file that take the seeds of random releases, and in its table FORMATS."""
    nodes = ast.parse(path.read_text()).body
    tests = [one for one in nodes if isinstance(one, ast.FunctionDef) and "seed" in {arg.arg for arg in one.args.args}]
    tables = [one for one in nodes if isinstance(one, ast.Assign) and ast.unparse(one.targets[0]) == "FORMATS"]
    found = [one for node in (*tests, *(tables if tests else ())) for one in ast.walk(node)]
    return {one.value for one in found if isinstance(one, ast.Constant) and isinstance(one.value, str)}


@pytest.mark.parametrize("name", FORMATS)
def test_it_is_read_back_from_random_releases(name):
    assert any(name in formats_of(path) for path in HERE.glob("test_*.py"))


def test_the_same_bytes_again_alone_and_among_all(random_release, exported, tmp_path, release_of):
    """Nothing is kept from one format to the next, and nothing is of the day."""
    root = random_release(1, annotated=True).root
    names = list(FORMATS)
    together = release_of(exported(root, tmp_path / "all", *names))
    assert {place.split("/")[0] for place in together} == {*names, "export.json"}
    for name in names:
        alone = release_of(exported(root, tmp_path / name, name))
        assert {place: data for place, data in alone.items() if place != "export.json"} == {
            place: data for place, data in together.items() if place.startswith(f"{name}/")
        }
