"""Stereo pairs: which cameras are one, and how KITTI's benchmark holds it."""

from types import SimpleNamespace

import numpy as np
import pytest

import symolo
from symolo.dataset.documents.camera_model import X_CB, CameraDocument
from symolo.exporters.kitti import EXPORTER as KITTI
from symolo.exporters.shared.stereo import StereoPair, stereo_pair
from symolo.reader.calibrated_camera import CalibratedCamera

K = ((100.0, 0.0, 79.5), (0.0, 100.0, 59.5), (0.0, 0.0, 1.0))
AHEAD = np.linalg.inv(X_CB)
"""X_RC of a camera in R that looks ahead: x of C is -y of R."""


def camera(y_m, x_m=0.0, turn_rad=0.0, D=(0.0,) * 5, period_s=0.2, **settings):
    X_RC = np.eye(4)
    c, s = np.cos(turn_rad), np.sin(turn_rad)
    X_RC[:2, :2] = [[c, -s], [s, c]]
    X_RC = X_RC @ AHEAD
    X_RC[:3, 3] = x_m, y_m, 0.1
    rows = tuple(map(tuple, X_RC.tolist()))
    sizes = {"width_px": 160, "height_px": 120, "exposure_s": 0.0, "read_out_s": 0.0} | settings
    document = CameraDocument.model_validate({**sizes, "K": K, "D": D, "X_RC": rows, "X_CB": X_CB})
    images = tuple(SimpleNamespace(t_s=period_s * i) for i in range(3))
    return SimpleNamespace(camera=CalibratedCamera.from_document(document), images=images, numbers=(1, 2, 3))


def run_of(**cameras):
    first = cameras.pop("camera", SimpleNamespace(numbers=()))
    first.cameras = cameras
    return first


def test_the_camera_on_the_right_is_the_second_whatever_its_name():
    assert stereo_pair(run_of(a=camera(-0.05), b=camera(0.07))) == StereoPair("b", "a", pytest.approx(0.12))
    with_first = run_of(camera=camera(0.0), a=camera(-0.05), b=camera(0.07))
    assert stereo_pair(with_first) == StereoPair("camera", "a", pytest.approx(0.05))


@pytest.mark.parametrize(
    "other",
    [
        camera(-0.05, x_m=0.001),
        camera(-0.05, turn_rad=0.001),
        camera(-0.05, period_s=0.1),
        camera(-0.05, width_px=162),
        camera(-0.05, exposure_s=0.001),
        camera(-0.05, D=(0.01, 0.0, 0.0, 0.0, 0.0)),
        camera(0.07),
    ],
    ids=["ahead", "turned", "other times", "other size", "other exposure", "distorted", "same place"],
)
def test_other_cameras_are_no_rectified_pair(other):
    assert stereo_pair(run_of(a=camera(0.07), b=other)) is None


@pytest.mark.parametrize(("D", "count"), [((0.0,) * 5, 0), ((-0.2, 0.0, 0.0, 0.0, 0.0), 1)])
def test_kitti_warns_of_a_lens_with_distortion(D, count):
    data = SimpleNamespace(runs=[run_of(camera=camera(0.0, D=D))])
    assert sum("D0" in text for text in KITTI.warnings(data)) == count


def test_equal_distortion_is_not_rectified():
    bent = (0.01, 0.0, 0.0, 0.0, 0.0)
    assert stereo_pair(run_of(a=camera(0.07, D=bent), b=camera(-0.05, D=bent))) is None


def test_kitti_projects_a_point_where_both_cameras_see_it(sensing_release, exported, tmp_path):
    out = exported(sensing_release, tmp_path / "out", "kitti") / "kitti"
    run, sequence = symolo.load(sensing_release)["CW/test_1"], out / "sequences/00"
    lines = [line.split(": ") for line in (sequence / "calib.txt").read_text().splitlines()]
    calibration = {name: np.array(numbers.split(), float) for name, numbers in lines}
    origin = np.vstack((np.loadtxt(sequence / "origin.txt").reshape(3, 4), [0, 0, 0, 1]))
    times_s, poses = np.loadtxt(sequence / "times.txt"), np.loadtxt(out / "poses/00.txt").reshape(-1, 3, 4)
    np.testing.assert_allclose(times_s, run.cameras["left"].t_s)
    for number, (name, P) in enumerate((("left", "P0"), ("right", "P1"))):
        one = run.cameras[name]
        for i, (pose, image) in enumerate(zip(poses, one.images, strict=True)):
            assert (sequence / f"image_{number}/{i:06d}.jpg").read_bytes() == image.path.read_bytes()
            p_W = image.X_WC @ [0.1, -0.05, 0.8, 1]  # seen by both cameras
            expected = one.camera.K @ [0.1, -0.05, 0.8]
            X_WC = origin @ np.vstack((pose, [0, 0, 0, 1]))
            seen = calibration[P].reshape(3, 4) @ np.linalg.inv(X_WC) @ p_W
            np.testing.assert_allclose(seen[:2] / seen[2], expected[:2] / expected[2], atol=1e-3)
    X_CR = np.vstack((calibration["Tr"].reshape(3, 4), [0, 0, 0, 1]))
    np.testing.assert_allclose(X_CR @ run.cameras["left"].camera.X_RC, np.eye(4), atol=1e-8)
    assert not (sequence / "image_2").exists()
