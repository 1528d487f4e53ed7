"""A camera whose rate does not divide that of data.csv, from the config to exports, and rendered again."""

import json

import numpy as np
import pytest

import symolo as library
from pipeline.cli import main
from symolo.core.geometry.poses import pose_X_WR
from symolo.dataset.tables.camera_rows import path_of
from symolo.playback.from_run import playback_of
from tests.release_fixtures import ONE_ROUTE

SETTINGS = (
    ONE_ROUTE,
    "stop.time_limit_s=0.6",
    "render.width_px=32",
    "render.height_px=24",
    "rates.camera_hz=30",
)
RUN = "CW/test_1"
T_MS = [0, 33, 67, 100, 133, 167, 200, 233, 267, 300, 333, 367, 400, 433, 467, 500, 533, 567, 600]


@pytest.fixture(scope="module")
def made(hands_of_module, tmp_path_factory):
    """A release at 30 Hz, with grey images in place of rendered ones; read only."""
    del hands_of_module
    root = tmp_path_factory.mktemp("rates") / "data"
    options = [f"--set={setting}" for setting in SETTINGS]
    assert main(["release", "smoke", "--out", str(root), "--workers", "1", *options]) == 0
    return root


def test_images_at_30_hz_have_their_own_times_and_the_poses_of_the_path(made, symolo):
    assert symolo("verify", made).out == f"{made}: no fault\n"
    run = library.load(made)[RUN]
    assert [round(1000 * image.t_s) for image in run.images] == T_MS
    assert run.rows["t"].tolist() == list(range(0, 601, 50))
    assert run.rows["img"].tolist() == [1, 2, 4, 5, 7, 8, 10, 11, 13, 14, 16, 17, 19]
    for image in run.images[::3]:  # those at a multiple of 100 ms are at rows
        np.testing.assert_array_equal(image.pose, run.table.pose[image.row])
    X_RC = run.camera.X_RC
    for image, track in zip(run.images, run.image_rows.itertuples(), strict=True):
        np.testing.assert_allclose(image.X_WC, pose_X_WR(*image.pose) @ X_RC, atol=1e-6)
        assert (track.img, track.t / 1000, track.x) == (image.number, image.t_s, image.pose[0])
        assert image.row == int(20 * image.t_s + 1e-6)
    metadata = json.loads((made / "metadata.json").read_text())
    assert metadata["runs"][0]["images"] == len(T_MS)
    assert [image.t_s for image in playback_of(run).cameras[0].images] == [t / 1000 for t in T_MS]


def test_a_release_is_rendered_again_at_any_other_rate(made, tmp_path, symolo):
    out = tmp_path / "again"
    ended = symolo("rerender", made, "--look", "lab", "--camera-hz", 7, "--out", out)
    assert ended.code == 0, ended.err
    assert symolo("verify", out).code == 0
    images = library.load(out)[RUN].images
    assert [round(1000 * image.t_s) for image in images] == [0, 143, 286, 429, 571]
    for image in images:
        X_WR = pose_X_WR(*path_of(library.load(made)[RUN].table).poses_at(np.array([image.t_s]))[0])
        np.testing.assert_allclose(image.X_WC, X_WR @ np.array(library.load(made)[RUN].camera.X_RC), atol=2e-6)


def test_exports_have_the_times_and_poses_of_the_images(made, tmp_path, symolo):
    formats = "tum,euroc"
    ended = symolo("export", made, "--format", formats, "--out", tmp_path / "out")
    assert ended.code == 0, ended.err
    poses = np.loadtxt(tmp_path / "out/tum" / RUN / "camera.txt")
    assert np.rint(1000 * poses[:, 0]).astype(int).tolist() == T_MS
    np.testing.assert_allclose(poses[:, 1:4], library.load(made)[RUN].X_WC[:, :3, 3], atol=1e-6)
    stamps = (tmp_path / "out/euroc" / RUN / "mav0/cam0/data.csv").read_text().splitlines()[1:]
    assert [(int(line.split(",")[0]) - 10**18) // 10**6 for line in stamps] == T_MS
    assert "rate_hz: 30\n" in (tmp_path / "out/euroc" / RUN / "mav0/cam0/sensor.yaml").read_text()


def test_verify_reports_images_and_numbers_that_are_not_those_of_the_rate(made, copy_of, sign, symolo):
    root = copy_of(made)
    (root / RUN / "images/000003.jpg").unlink()
    data = (root / RUN / "data.csv").read_text().splitlines()
    assert data[2].endswith(",2")
    (root / RUN / "data.csv").write_text("\n".join([*data[:2], data[2][:-1] + "3", *data[3:]]) + "\n")
    positions = (root / RUN / "image_positions.txt").read_text().splitlines()
    (root / RUN / "image_positions.txt").write_text("\n".join([*positions[:3], positions[2], *positions[4:]]) + "\n")
    sign(root)
    ended = symolo("verify", root)
    assert ended.code == 4
    for fault in (
        "images: 000003.jpg is missing",
        "data.csv: line 3: column img: 3 does not keep 30 Hz",
        "image_positions.txt: line 4: is not the pose of image 3",
    ):
        assert f"{RUN}/{fault}" in ended.out + ended.err
