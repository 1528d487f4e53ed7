"""Further cameras from the config to the checked release: a stereo pair and a fisheye lens at the rear."""

import fnmatch
import json
import shutil

import cv2
import numpy as np
import pytest

import symolo as library
from configs.draw import draw_run
from configs.loader import load_scenario
from pipeline.cli import main
from pipeline.stages.cameras import cameras_of
from symolo.core.errors import InputError
from symolo.core.geometry.pinhole import pose_X_RC
from symolo.core.geometry.poses import pose_X_WR
from symolo.playback.from_run import playback_of

SMALL = "width_px: 32, height_px: 24"
CAMERAS = {
    "left": f"{{kind: camera, x_m: 0.05, y_m: 0.03, z_m: 0.1, pitch_up_deg: -20, period_s: 0.125, {SMALL}}}",
    "right": f"{{kind: camera, x_m: 0.05, y_m: -0.03, z_m: 0.1, pitch_up_deg: -20, period_s: 0.125, {SMALL}}}",
    "rear": f"{{kind: camera, x_m: -0.08, yaw_deg: 180, period_s: 0.3, delay_s: 0.1, fisheye: {{}}, {SMALL}}}",
}
SETTINGS = [
    "routes=[{name: CW, start: {x_m: 0.55, y_m: -0.20, yaw_deg: -90}, runs: 1}]",
    "stop.time_limit_s=0.6",
    "render.width_px=32",
    "render.height_px=24",
    *(f"robot.sensors.{name}={settings}" for name, settings in CAMERAS.items()),
]
RUN = "CW/test_1"
IMAGES = {"": 4, "left": 5, "right": 5, "rear": 3}


def drawn(*settings):
    return draw_run(load_scenario("smoke", [*SETTINGS, *settings]), "CW", 1)


def options(*settings):
    return ["--workers", "1", *(f"--set={setting}" for setting in (*SETTINGS, *settings))]


@pytest.fixture(scope="module")
def made(hands_of_module, tmp_path_factory):
    """The release, with grey images in place of rendered ones; read only."""
    del hands_of_module
    root = tmp_path_factory.mktemp("cameras") / "data"
    assert main(["release", "smoke", "--out", str(root), *options()]) == 0
    return root


def test_each_camera_has_its_own_images_poses_and_intrinsics(made, symolo):
    assert symolo("verify", made).out == f"{made}: no fault\n"
    record = json.loads((made / "metadata.json").read_text())["runs"][0]
    assert {name: camera["images"] for name, camera in record["cameras"].items()} | {"": record["images"]} == IMAGES
    run = library.load(made)[RUN]
    assert list(run.cameras) == ["left", "rear", "right"]
    assert [track.name for track in playback_of(run).cameras] == ["camera", "left", "rear", "right"]
    for name, camera in run.cameras.items():
        np.testing.assert_allclose(camera.t_s, np.arange(IMAGES[name]) * (0.3 if name == "rear" else 0.125))
        assert {image.pixels().shape for image in camera.images} == {(24, 32, 3)}
        X_RC = np.array(camera.camera.X_RC)
        for image in camera.images:
            np.testing.assert_allclose(image.X_WC, pose_X_WR(*image.pose) @ X_RC, atol=1e-6)
    left, right, rear = (run.cameras[name].camera for name in ("left", "right", "rear"))
    # The right camera is 60 mm to the right of the left one in the axes of the camera: a rectified pair.
    between = np.linalg.inv(np.array(left.X_RC)) @ np.array(right.X_RC)
    np.testing.assert_allclose(between, [[1, 0, 0, 0.06], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]], atol=1e-6)
    assert (rear.camera_model, rear.distortion_model, rear.D) == ("fisheye", "equidistant", (0.0, 0.0, 0.0, 0.0))
    # The image is as wide as the field of view of 185 degrees.
    assert rear.K[0][0] == pytest.approx(16 / np.radians(92.5))
    np.testing.assert_array_equal(np.array(rear.X_RC)[:3, 2].round(9), [-1, 0, 0])
    assert run.cameras["rear"].delivered(np.array([0.0, 0.39, 0.41, 0.75])).tolist() == [0, 0, 1, 2]


def test_verify_reports_damage_in_the_folders_of_cameras(made, copy_of, sign, symolo):
    root = copy_of(made)
    left, right, rear = (root / RUN / "cameras" / name for name in ("left", "right", "rear"))
    (left / "images/000002.jpg").unlink()
    shutil.copy(left / "images/000001.jpg", left / "images/000009.jpg")
    shutil.copy(rear / "side/intrinsics.json", left / "side/intrinsics.json")
    shutil.copy(left / "side/camera.csv", right / "side/camera.csv")
    shutil.copy(rear / "image_positions.txt", right / "image_positions.txt")
    cv2.imwrite(str(right / "images/000002.jpg"), np.zeros((24, 30, 3), np.uint8))
    shutil.rmtree(rear)
    sign(root)
    ended = symolo("verify", root)
    assert ended.code == 4
    for fault in (
        "left/images: 000002.jpg is missing",
        "left/images: 000009.jpg is not named in its period",
        "left/side/intrinsics.json: ",
        "right/side/camera.csv: ",
        "right/image_positions.txt: 3 positions for 5 images in its path",
        "right/images/000002.jpg: is 30 x 24 px, metadata.json says 32 x 24",
        "rear: the folder is missing",
    ):
        assert f"{RUN}/cameras/{fault}" in ended.out + ended.err


def test_repair_makes_files_of_a_camera_again(made, copy_of, release_of, symolo):
    root = copy_of(made)
    folder = root / RUN / "cameras/left"
    (folder / "image_positions.txt").write_text("")
    (folder / "side/camera.csv").unlink()
    (folder / "images/000003.jpg").write_bytes(b"")
    assert symolo("repair", root).code == 0
    assert release_of(root) == release_of(made)


def test_only_a_camera_that_changed_is_rendered_again_and_the_rest_depends_on_no_camera(
    made, hands_of_module, copy_of, release_of, symolo, monkeypatch
):
    root, painted, paint = copy_of(made, stages=True), [], hands_of_module.paint
    monkeypatch.setattr(hands_of_module, "paint", lambda unit: (painted.append(unit.name), paint(unit)))
    assert symolo("release", "smoke", "--out", root, *options()).code == 0
    assert not painted
    assert symolo("release", "smoke", "--out", root, *options("robot.sensors.rear.fisheye.k1=0.01")).code == 0
    assert set(painted) == {f"{RUN} camera rear"}
    assert symolo("release", "smoke", "--out", root, *options(*(f"robot.sensors.{n}=null" for n in CAMERAS))).code == 0
    assert set(painted) == {f"{RUN} camera rear"}
    before = {name: data for name, data in release_of(made).items() if "/cameras/" not in name and "spec" not in name}
    after = release_of(root)
    assert {name for name in after if name.startswith(RUN)} == {n for n in before if n.startswith(RUN)} | {
        f"{RUN}/side/spec.json"
    }
    assert all(after[name] == data for name, data in before.items() if name.startswith(RUN))
    assert "cameras" not in json.loads(after["metadata.json"])["runs"][0]


def test_a_further_camera_is_rendered_at_the_place_of_its_settings():
    nominal, left, rear, _ = cameras_of(drawn())
    assert nominal.spec.robot.camera.x_m == drawn().robot.camera.x_m
    base_m = left.spec.robot.chassis.base_height_m
    np.testing.assert_allclose(pose_X_RC(left.spec.robot.camera, base_m)[:3, 3], [0.05, 0.03, 0.1])
    np.testing.assert_allclose(
        pose_X_RC(left.spec.robot.camera, base_m)[:3, 2], [np.cos(np.pi / 9), 0, -np.sin(np.pi / 9)]
    )
    assert (rear.spec.render.method, rear.spec.robot.camera.fisheye.field_of_view_deg) == ("full", 185.0)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ("{kind: camera, period_s: 0.0333}", r"rear\.period_s: got 0\.0333, allowed: whole milliseconds.*write 0\.033"),
        ("{kind: camera, fisheye: {k1: -1}}", r"sensors\.rear\.fisheye: the lens folds the image back"),
        ("{kind: camera, fisheye: null, distortion: {k1: -1}}", r"sensors\.rear\.distortion: the lens folds"),
        ("{kind: camera, fisheye: {}, distortion: {k1: 0.1}}", r"rear\.distortion: it is that of a pinhole camera"),
        ("{kind: camera, x_m: 0.9}", r"robot\.sensors\.rear.*0\.5"),
        ("{kind: camera, annotations: [depths]}", "did you mean depth"),
    ],
)
def test_an_impossible_camera_is_refused_before_anything_is_made(settings, message):
    with pytest.raises(InputError, match=message):
        drawn(f"robot.sensors.rear={settings}")


def test_the_camera_of_data_csv_has_no_fisheye_lens():
    with pytest.raises(InputError, match=r"robot\.camera\.fisheye: the camera of data\.csv has no fisheye lens"):
        drawn("robot.camera.fisheye={}")


def test_the_plan_counts_the_images_of_each_camera(symolo):
    settings = [f"--set={setting}" for setting in SETTINGS]
    out = symolo("plan", "smoke", *settings).out
    assert "CW/test_1 rear" in out
    assert f"images     {sum(IMAGES.values())}\n" in out
    document = json.loads(symolo("plan", "smoke", "--json", *settings).out)
    assert document["images"] == sum(IMAGES.values())
    assert {camera["run"]: camera["images"] for camera in document["cameras"]} == {
        f"{RUN} {name}": count for name, count in IMAGES.items() if name
    }


def test_croissant_counts_the_images_of_the_camera_of_data_csv_only(made, tmp_path, symolo):
    """Its readers take a `*` for several folders, as Python's fnmatch does."""
    about = tmp_path / "about.yaml"
    about.write_text('{title: Cameras, authors: [{family: Anyone}], published: "2026-11-22", publisher: Nobody}')
    ended = symolo("pack", made, "--about", about, "--out", tmp_path / "packed")
    assert ended.code == 0, ended.err
    croissant = json.loads((tmp_path / "packed/croissant.json").read_text())
    (patterns,) = (one["includes"] for one in croissant["distribution"] if "includes" in one)
    name = json.loads((made / "metadata.json").read_text())["name"]
    files = [f"{name}/{path.relative_to(made).as_posix()}" for path in made.rglob("*.jpg")]
    matched = {file for file in files for pattern in patterns if fnmatch.fnmatch(file, pattern)}
    assert matched == {f"{name}/{RUN}/images/{number:06d}.jpg" for number in range(1, IMAGES[""] + 1)}
