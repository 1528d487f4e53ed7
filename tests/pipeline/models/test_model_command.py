import xml.etree.ElementTree as ET

import pytest

from pipeline.cli import main


def test_the_command_writes_what_is_asked_for(tmp_path, capsys):
    out = tmp_path / "model"
    assert main(["model", "smoke", "--out", str(out), "--route", "CCW", "--format", "urdf"]) == 0
    assert [path.name for path in out.iterdir()] == ["robot.urdf"]
    assert capsys.readouterr().out == f"{out}: robot.urdf of CCW/test_1\n"


def test_a_robot_that_its_camera_sees_has_all_its_parts_and_is_hidden_no_longer(tmp_path):
    out = tmp_path / "model"
    assert main(["model", "smoke", "--out", str(out), "--set", "robot.camera.sees_robot=true"]) == 0
    visuals = ET.parse(out / "robot.sdf").iter("visual")  # noqa: S314 - our own file
    hidden = {visual.get("name"): visual.find("visibility_flags") is not None for visual in visuals}
    assert {"robot_plate", "robot_mast", "robot_tof_front"} <= set(hidden)
    assert [name for name, is_hidden in hidden.items() if is_hidden] == ["robot_camera"]


def test_what_moves_in_a_run_is_said_to_stand_still(tmp_path, capsys):
    out = tmp_path / "model"
    assert main(["model", "moving", "--out", str(out), "--format", "urdf"]) == 0
    assert "the files show them at t = 0: Crosser, Patrol\n" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--format", "urdf,sfd"], "--format: got 'sfd', allowed: urdf, sdf; did you mean sdf"),
        (["--route", "CVV"], "route: got 'CVV', allowed: CW, CCW"),
        (["--run", "2"], "--run: got 2, allowed: 1 to 1 on route CW"),
        (["--set", "robot.drive.track_m=2"], "robot.drive.track_m"),
    ],
)
def test_what_cannot_be_written_is_refused_before_a_folder_is_made(tmp_path, capsys, arguments, message):
    out = tmp_path / "model"
    assert main(["model", "smoke", "--out", str(out), *arguments]) == 2
    assert message in capsys.readouterr().err
    assert not out.exists()


def test_a_folder_with_something_in_it_is_left_alone(tmp_path, capsys):
    (tmp_path / "mine.txt").write_text("mine")
    assert main(["model", "smoke", "--out", str(tmp_path)]) == 2
    assert "is there already" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]
