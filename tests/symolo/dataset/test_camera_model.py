"""What side/intrinsics.json and side/camera.csv say of the camera, against OpenCV and REP 103."""

import json

import cv2
import numpy as np
import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from symolo.dataset.documents.camera_model import X_CB, CameraDocument, camera_table, read_camera_document
from symolo.dataset.tables.rows import Rows
from symolo.dataset.tables.side_tables import CAMERA

SETTINGS = [
    "robot.camera.distortion.k1=-0.2",
    "robot.camera.distortion.k2=0.05",
    "robot.camera.principal_point_right_mm=0.5",
    "robot.camera.read_out_s=0.016",
    "look.camera.exposure_time_s=0.008",
]


@pytest.fixture(scope="module")
def spec():
    return draw_run(load_scenario("smoke", SETTINGS), "CW", 1)


@pytest.fixture(scope="module")
def rows() -> Rows:
    table = np.zeros((3, 19))
    table[:, 0], table[:, 1:4], table[:, 18] = (0, 50, 200), [[0, 0, 0], [0, 0, 0], [0.3, -0.4, 1.2]], (1, 0, 2)
    return Rows.from_table(table)


def test_a_user_finds_a_floor_point_in_the_picture_with_opencv_and_the_files_alone(spec, rows, tmp_path):
    (tmp_path / "intrinsics.json").write_bytes(CameraDocument.from_imaging(spec).to_json())
    model = json.loads((tmp_path / "intrinsics.json").read_text())
    (tmp_path / "camera.csv").write_bytes(CAMERA.to_csv(camera_table(spec, rows)))
    image = np.genfromtxt(tmp_path / "camera.csv", delimiter=",", names=True)[1]
    R_WC = np.array([[image[f"r{row}{column}"] for column in (1, 2, 3)] for row in (1, 2, 3)])
    p_WC = np.array([image[f"p_{axis}"] for axis in "xyz"])
    # The axis meets the floor 0.12 / tan 30 deg ahead of the camera, at x = 0.05 of the robot.
    reach = 0.05 + 0.12 / np.tan(np.radians(30))
    point = np.array([[0.3 + reach * np.cos(1.2), -0.4 + reach * np.sin(1.2), 0.0]])
    turn, _ = cv2.Rodrigues(R_WC.T)
    pixel, _ = cv2.projectPoints(point, turn, -R_WC.T @ p_WC, np.array(model["K"]), np.array(model["D"]))
    assert pixel[0, 0] == pytest.approx([79.5 + 0.5 * 160 / 42.33, 59.5], abs=1e-3)
    assert model["D"] == [-0.2, 0.05, 0.0, 0.0, 0.0]
    assert (model["width_px"], model["height_px"]) == (160, 120)


def test_the_body_frame_is_that_of_rep_103():
    forward, left, up = np.array(X_CB)[:3, :3].T
    assert forward.tolist() == [0, 0, 1]  # along the optical z
    assert left.tolist() == [-1, 0, 0]  # against the optical x, which is right
    assert up.tolist() == [0, -1, 0]  # against the optical y, which is down


def test_the_exposure_of_the_first_row_begins_half_of_everything_before_the_stamp(spec, rows):
    table = camera_table(spec, rows)
    at = CAMERA.header.index("exposure_start")
    # The middle of row 0 of 120 is half a row after the read-out begins.
    assert table[:, at] == pytest.approx(np.array([0, 200]) - 4 - 8 + 8 / 120)
    assert table[:, at + 1] == pytest.approx(8)


def test_an_instant_is_exposed_at_its_stamp(rows):
    table = camera_table(draw_run(load_scenario("smoke", []), "CW", 1), rows)
    assert table[:, -2:].tolist() == [[0, 0], [200, 0]]


def test_a_manual_exposure_is_stated_with_speed_and_f_number(spec):
    settings = ("look.camera.exposure_time_s=0.01", "look.camera.manual_exposure={iso: 200, f_number: 4}")
    document = CameraDocument.from_imaging(draw_run(load_scenario("smoke", settings), "CW", 1))
    assert (document.exposure_s, document.iso, document.f_number) == (0.01, 200, 4)
    assert not {"iso", "f_number"} & json.loads(CameraDocument.from_imaging(spec).to_json()).keys()


def test_what_is_written_is_read_again_and_damage_is_reported(spec, tmp_path):
    model = CameraDocument.from_imaging(spec)
    path = tmp_path / "intrinsics.json"
    path.write_bytes(model.to_json())
    assert read_camera_document(path) == model
    path.write_text(path.read_text().replace('"K"', '"k"'))
    with pytest.raises(ValueError, match=r"^K: "):
        read_camera_document(path)
