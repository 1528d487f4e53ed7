"""Simulated drives of 15 s: nothing is found in a faultless one, and faults of ranges and wheels beside each other."""

import json

import pytest

from pipeline.cli import main

pytestmark = pytest.mark.long
"""A simulation and a diagnosis take 20 to 40 s of CPU time."""


def answer(folder, *settings):
    drive = [text for setting in ("stop.time_limit_s=15", *settings) for text in ("--set", setting)]
    assert main(["simulate", "smoke", "--out", str(folder / "drive"), *drive]) == 0
    assert main(["diagnose", str(folder / "drive"), "--out", str(folder / "found")]) == 0
    return json.loads((folder / "found" / "answer.json").read_bytes())


@pytest.mark.parametrize("seed", [1, 2])
def test_a_faultless_drive_is_explained(tmp_path, seed):
    content = answer(tmp_path, f"seed={seed}")
    assert content["conclusion"] == "explained"
    assert content["effects"] == []
    assert not content["unexplained"]


def test_a_fault_of_the_ranges_and_one_of_the_wheels_are_named_with_their_sizes(tmp_path):
    hidden = {"tof_range_scale": 1.05, "wheelbase_scale": 1.04}
    content = answer(tmp_path, *(f"robot.effects.{name}.scale={size}" for name, size in hidden.items()))
    assert not content["unexplained"]
    assert {effect["name"] for effect in content["effects"]} == hidden.keys()
    for effect in content["effects"]:
        assert effect["parameters"]["scale"] == pytest.approx(hidden[effect["name"]], abs=4.0 * effect["std"]["scale"])
