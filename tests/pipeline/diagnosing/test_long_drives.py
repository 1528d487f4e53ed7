"""A drive with the voltages of its motors may take minutes, which is said before."""

import numpy as np
import pytest

import pipeline.diagnosing.diagnose
from symolo.core.errors import InputError

HEADER = "t,encL,encR,uL,uR,x,y,theta"
VOLTAGES = ["  u_left_V:", "  u_right_V:"]


@pytest.fixture
def case(tmp_path, symolo):
    """A drive of 20 s on a circle of 1 m, with 20 rows a second."""
    t = 0.05 * np.arange(400)
    ticks = np.round(2000 * t).astype(int)
    columns = (t, ticks, ticks + np.round(200 * t).astype(int), 3.0 + 0 * t, 3.0 + 0 * t, np.sin(t), 1 - np.cos(t), t)
    rows = [",".join(f"{cell:.6g}" for cell in row) for row in zip(*columns, strict=True)]
    (tmp_path / "run.csv").write_text("\n".join([HEADER, *rows]) + "\n")
    symolo("case", "init", tmp_path / "run.csv", "--out", tmp_path / "case")
    return tmp_path / "case"


@pytest.fixture
def printed(symolo, tmp_path, monkeypatch):
    """What `symolo diagnose` prints until the fits begin, which are left out."""

    def stop(*_arguments, **_options):
        raise InputError("the fits begin")

    def of(case):
        monkeypatch.setattr(pipeline.diagnosing.diagnose, "diagnose_cases", stop)
        return symolo("diagnose", case, "--out", tmp_path / "out").err

    return of


def test_a_drive_with_voltages_is_announced_with_what_is_faster(case, printed):
    before, begin = printed(case).splitlines()
    assert before.startswith("note: the drive has voltages of both motors: ")
    assert "whose mapping.yaml lacks u_left_V and u_right_V answers only wheels and floor, in seconds" in before
    assert "the fits begin" in begin


def test_a_mapping_without_its_voltages_makes_a_case_without_the_note(case, printed, symolo, tmp_path):
    mapping = [
        line for line in (case / "mapping.yaml").read_text().splitlines() if line[: line.find(":") + 1] not in VOLTAGES
    ]
    (tmp_path / "wheels.yaml").write_text("\n".join(mapping) + "\n")
    ended = symolo(
        "case", "init", tmp_path / "run.csv", "--mapping", tmp_path / "wheels.yaml", "--out", tmp_path / "wheels"
    )
    assert "not compared: speeds of the wheels from voltages" in ended.out
    assert "note:" not in printed(tmp_path / "wheels")
