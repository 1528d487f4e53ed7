"""Classes of processors that made the frames of a run, which are reported if they are several; and the threads of
linear algebra.
"""

import json
import os
import sys

import pytest

from pipeline.work.processors import ONE_THREAD, use_one_thread

SMALL = ["--set=stop.time_limit_s=0.4", "--set=render.width_px=32", "--set=render.height_px=24", "--workers=1"]
ONE, OTHER = "x86-64-v8 OneMaker family 1", "x86-64-v9 OtherMaker family 2"
"""Of no machine on which this runs."""
TOLD = f"CW/test_1: its frames were made on {ONE} and {OTHER}: low bits may not be those of a machine of one class"


@pytest.fixture
def made(hands, symolo, tmp_path):
    """A release whose frame 1 of the route CW was made on one class, and the rest on another."""
    plain = hands.paint

    def by_two(unit):
        first = [number for number in unit.numbers if number == 1 and unit.name.startswith("CW/")]
        for numbers, cpu in ((first, OTHER), ([n for n in unit.numbers if n not in first], ONE)):
            plain(unit.model_copy(update={"numbers": tuple(numbers)}), cpu=cpu)

    def release(*, mixed):
        out = tmp_path / f"mixed_{mixed}"
        hands.paint = by_two if mixed else lambda unit: plain(unit, cpu=ONE)
        return out, symolo("release", "smoke", "--out", out, *SMALL)

    return release


def test_a_run_of_two_classes_is_reported_at_assembly_in_metadata_and_by_status(made, symolo):
    out, ended = made(mixed=True)
    assert ended.code == 0
    assert f"assemble: {TOLD}" in ended.err.splitlines()
    runs = {run["run"]: run for run in json.loads((out / "metadata.json").read_text())["runs"]}
    assert runs["CW/test_1"]["cpu_classes"] == [ONE, OTHER]
    assert "cpu_classes" not in runs["CCW/test_1"]
    info = (out / "bag-info.txt").read_text()
    assert {f"CPU-Class: {ONE}", f"CPU-Class: {OTHER}"} <= {*info.splitlines()}
    assert TOLD in symolo("status", out).out.splitlines()
    assert symolo("verify", out).code == 0
    (out / "bag-info.txt").unlink()  # which `repair` knows how to write again
    assert symolo("repair", out).code == 0
    assert (out / "bag-info.txt").read_text() == info


def test_a_run_of_one_class_is_as_it_was_before_classes_were_noted(made, symolo, hands):
    out, ended = made(mixed=False)
    assert "its frames were made on" not in ended.err + symolo("status", out).out
    before = (out / "metadata.json").read_bytes()
    for journal in (out / ".stages").rglob("*.jsonl"):
        lines = [json.loads(line) for line in journal.read_text().splitlines()]
        for line in lines:
            assert line["frame"].pop("cpu") == ONE
        journal.write_text("".join(json.dumps(line) + "\n" for line in lines))  # as the version before this one
        (journal.with_name("done.json")).unlink()
    hands.paint = lambda _unit: None  # it is all there
    again = symolo("release", "smoke", "--out", out, *SMALL)
    assert (again.code, (out / "metadata.json").read_bytes()) == (0, before)
    assert ONE not in (out / "bag-info.txt").read_text()


@pytest.mark.parametrize("is_loaded", [False, True])
def test_threads_are_limited_as_long_as_linear_algebra_is_not_loaded(is_loaded, monkeypatch):
    for name in ONE_THREAD:
        monkeypatch.setenv(name, "3")
    if not is_loaded:
        monkeypatch.delitem(sys.modules, "numpy")
    assert use_one_thread() is not is_loaded
    assert {os.environ[name] for name in ONE_THREAD} == {"3" if is_loaded else "1"}
