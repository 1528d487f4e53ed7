"""The round trip of docs/diagnosis.md: its commands run as they stand there, and the robot found is the hidden one."""

import json
import re
import shlex
from pathlib import Path

import pytest

from pipeline.cli import main

pytestmark = pytest.mark.documents
PAGE = Path(__file__).parents[3] / "docs/diagnosis.md"
SECTION = PAGE.read_text().partition("\n## Try it where the answer is known\n")[2].partition("\n## ")[0]


@pytest.fixture(scope="module")
def trip(tmp_path_factory):
    """Where the commands of the page have run."""
    folder = tmp_path_factory.mktemp("trip")
    commands = re.findall(r"^    symolo (.+)$", SECTION, re.MULTILINE)
    assert [command.split()[0] for command in commands] == ["simulate", "diagnose", "simulate", "diagnose"]
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for command in commands:
            assert main(shlex.split(command)) == 0, command
    return folder


def test_both_hidden_effects_are_named_with_their_sizes(trip):
    content = json.loads((trip / "hidden-diagnosis" / "answer.json").read_bytes())
    assert not content["unexplained"]
    effects = {effect["name"]: effect for effect in content["effects"]}
    assert effects.keys() == {"wheel_radius_asymmetry", "wheelbase_scale"}
    for name, number, hidden in (("wheel_radius_asymmetry", "asymmetry", 0.03), ("wheelbase_scale", "scale", 1.06)):
        assert abs(effects[name]["parameters"][number] - hidden) < 2.0 * effects[name]["std"][number]
        assert effects[name]["parameters"][number] == pytest.approx(hidden, abs=0.003)


def test_by_pybullet_the_found_robot_drives_the_same_path(trip):
    errors = json.loads((trip / "hidden-diagnosis" / "answer.json").read_bytes())["engines"]["PyBullet"]["errors"]
    for name in ("pose_dx_m", "pose_dtheta_rad"):
        assert errors[name]["extended"] < 0.2 * errors[name]["nominal"]
    summary = (trip / "hidden-diagnosis" / "summary.txt").read_text()
    open_loop = " ".join(summary.split()).partition("from the voltages alone")[2]
    before, after = map(float, re.findall(r"([0-9.]+) mm", open_loop))
    assert after < 0.1 * before


def test_with_the_found_robot_for_the_nominal_one_nothing_is_wrong_and_its_dataset_covers_the_drive(trip):
    check = json.loads((trip / "check" / "answer.json").read_bytes())
    assert check["effects"] == []
    assert not check["unexplained"]
    assert all(of["covered"] for of in check["against"]["left"].values())
