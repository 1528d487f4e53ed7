"""The command `symolo identify-camera` with input that cannot be used."""

import pytest

from pipeline.cli import main

DATA = "t,x,y,theta,state,v,w,d_f,d_l,d_r,L0,L1,L2,L3,L4,L5,L6,L7,img\n"
ROW = "{t},0.1,0.2,0.3,1,0.1,0.0,1,1,1,1,1,1,0,0,1,1,1,{img}\n"


@pytest.fixture
def run(tmp_path):
    folder = tmp_path / "run"
    (folder / "images").mkdir(parents=True)
    (folder / "data.csv").write_text(DATA + "".join(ROW.format(t=50 * k, img=k + 1) for k in range(8)))
    return folder


def refused(capsys, *arguments):
    assert main(["identify-camera", *map(str, arguments)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    return line


def test_a_folder_that_is_not_there_is_refused(tmp_path, capsys):
    assert "no such folder" in refused(capsys, tmp_path / "none", "--out", tmp_path / "out")


def test_a_run_without_a_nominal_camera_is_refused(run, tmp_path, capsys):
    line = refused(capsys, run, "--out", tmp_path / "out")
    assert "spec.json" in line
    assert "--simulated" in line
    assert not (tmp_path / "out").exists()


def test_a_run_without_images_is_refused(run, tmp_path, capsys):
    (run / "images").rmdir()
    assert "images" in refused(capsys, run, "--out", tmp_path / "out")
