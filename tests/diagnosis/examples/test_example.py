"""The shipped example cases: they are whole in the package, and `symolo case example` copies them."""

import json
import math
import tomllib
from collections import Counter
from pathlib import Path

import pytest

from diagnosis.examples.example import FOLDER, example_of, examples
from diagnosis.importers.choose import read_measurement
from diagnosis.measured.case_files.nominal import MODELS
from pipeline.cli import main
from pipeline.diagnosing.importers import IMPORTERS
from symolo.core.errors import InputError

ROOT = Path(__file__).parents[3]
FILES = {path for path in FOLDER.rglob("*") if path.suffix in {".csv", ".yaml", ".json"}}


def test_there_are_two_examples_of_each_kind():
    counts = Counter(case.kind for case in examples())
    assert set(counts) == set(MODELS)
    assert min(counts.values()) >= 2


def test_every_file_of_the_examples_is_package_data():
    patterns = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["package-data"]
    assert {path for pattern in patterns["diagnosis.examples"] for path in FOLDER.glob(pattern)} == FILES


@pytest.mark.parametrize("case", examples(), ids=lambda case: case.name)
def test_a_copy_has_the_same_bytes_and_can_be_read(case, tmp_path):
    case.copy(tmp_path / "copy")
    copied = {path.relative_to(tmp_path / "copy"): path.read_bytes() for path in (tmp_path / "copy").rglob("*.*")}
    assert copied == {
        path.relative_to(case.folder): path.read_bytes() for path in FILES if path.is_relative_to(case.folder)
    }
    assert read_measurement(tmp_path / "copy", IMPORTERS).kind == case.kind


def test_the_name_of_a_kind_means_an_example_with_a_hidden_effect():
    answers = json.loads((FOLDER / "answers.json").read_text())
    for kind in {case.kind for case in examples()}:
        assert answers[example_of(kind).name]["effects"]


def test_the_command_copies_an_example_and_prints_what_it_hides(tmp_path, capsys):
    assert main(["case", "example", "motor_steady", "--out", str(tmp_path / "case")]) == 0
    printed = capsys.readouterr().out
    assert "torque_constant_scale (scale 0.9299)" in printed  # answers.json: 0.92992737
    assert f"symolo diagnose {tmp_path / 'case'}" in printed
    assert main(["case", "example", "motor_step", "--out", str(tmp_path / "step")]) == 0
    printed = capsys.readouterr().out
    same_delay_s = 0.005 / (math.exp(0.005 / 0.004658299433420772) - 1.0)  # the converted one is what a diagnosis fits
    assert f"= {same_delay_s:.6f}. See" in printed
    assert main(["case", "example", "tof_bench_003", "--out", str(tmp_path / "other")]) == 0
    assert "It hides no effect" in capsys.readouterr().out


def test_an_unknown_example_and_a_folder_in_use_are_refused(tmp_path, capsys):
    with pytest.raises(InputError, match="did you mean motor_steady"):
        example_of("motor_stedy")
    (tmp_path / "note.txt").write_text("mine")
    assert main(["case", "example", "motor_step", "--out", str(tmp_path)]) == 2
    assert "is there already" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["note.txt"]
