"""Further cameras from the config to the checked release: a stereo pair and a fisheye lens at the rear."""

import fnmatch
import json
import shutil
from dataclasses import replace

import cv2
import numpy as np
import pytest

import symolo as library
from blender_scenes.render.job import FramePose
from blender_scenes.render.sampling import rendering_of
from configs.draw import draw_run
from configs.loader import load_scenario
from pipeline.cli import main
from pipeline.stages.cameras import cameras_of
from pipeline.stages.render import Appearance
from symolo.arena.geometry import Arena
from symolo.core.errors import InputError
from symolo.core.geometry.pinhole import pose_X_RC
from symolo.core.geometry.poses import pose_X_WR
from symolo.core.geometry.robot_path import RobotPath
from symolo.dataset.tables.rows import Rows
from symolo.pages.sheet import LINE_PX
from symolo.playback.from_run import playback_of
from tests.release_fixtures import ONE_ROUTE

SMALL = "width_px: 32, height_px: 24"
CAMERAS = {
    "left": f"{{kind: camera, x_m: 0.05, y_m: 0.03, z_m: 0.1, pitch_up_deg: -20, period_s: 0.125, {SMALL}}}",
    "right": f"{{kind: camera, x_m: 0.05, y_m: -0.03, z_m: 0.1, pitch_up_deg: -20, period_s: 0.125, {SMALL}}}",
    "rear": f"{{kind: camera, x_m: -0.08, yaw_deg: 180, period_s: 0.3, delay_s: 0.1, fisheye: {{}}, {SMALL}}}",
}
SETTINGS = [
    ONE_ROUTE,
    "stop.time_limit_s=0.6",
    "render.width_px=32",
    "render.height_px=24",
    *(f"robot.sensors.{name}={settings}" for name, settings in CAMERAS.items()),
]
HYBRID = ["robot.camera.fisheye={}", "render.method=hybrid"]
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


def test_a_contact_sheet_shows_a_further_camera_by_its_name(made, symolo, tmp_path):
    sheet = ("contact-sheet", made, "--width-px", 32, "--per-run", 9, "--out", tmp_path / "sheet.png")
    assert symolo(*sheet).out.endswith("not shown: the cameras left, rear, right; see one of them with --camera NAME\n")
    assert cv2.imread(str(tmp_path / "sheet.png")).shape[1] == 32 * IMAGES[""]
    for name in ("left", "rear"):
        ended = symolo(*sheet, "--camera", name)
        assert ended.out == f"{tmp_path / 'sheet.png'}: 1 run, {32 * IMAGES[name]} x {24 + LINE_PX} px\n"
        assert cv2.imread(str(tmp_path / "sheet.png")).shape == (24 + LINE_PX, 32 * IMAGES[name], 3)
    refused = symolo(*sheet, "--camera", "reer")
    assert refused.code == 2
    assert "--camera: got 'reer', allowed: one of left, rear, right; did you mean rear" in refused.err


def test_each_camera_has_its_own_images_poses_and_intrinsics(made, symolo):
    assert symolo("verify", made).out == f"{made}: no fault\n"
    record = json.loads((made / "metadata.json").read_text())["runs"][0]
    assert {name: camera["images"] for name, camera in record["cameras"].items()} | {"": record["images"]} == IMAGES
    run = library.load(made)[RUN]
    assert list(run.cameras) == ["left", "rear", "right"]
    with pytest.raises(
        KeyError, match=f"{RUN} has no further camera 'reer'; allowed: left, rear, right; did you mean rear"
    ):
        run.cameras["reer"]
    with pytest.raises(KeyError, match=f"{RUN} has no sensor 'lidar'; allowed: none"):
        run.sensors["lidar"]
    assert [track.name for track in playback_of(run).cameras] == ["camera", "left", "rear", "right"]
    for name, camera in run.cameras.items():
        np.testing.assert_allclose(camera.t_s, np.arange(IMAGES[name]) * (0.3 if name == "rear" else 0.125))
        assert {image.pixels().shape for image in camera.images} == {(24, 32, 3)}
        X_RC = camera.camera.X_RC
        for image in camera.images:
            np.testing.assert_allclose(image.X_WC, pose_X_WR(*image.pose) @ X_RC, atol=1e-6)
    left, right, rear = (run.cameras[name].camera for name in ("left", "right", "rear"))
    # The right camera is 60 mm to the right of the left one in the axes of the camera: a rectified pair.
    between = np.linalg.inv(left.X_RC) @ right.X_RC
    np.testing.assert_allclose(between, [[1, 0, 0, 0.06], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]], atol=1e-6)
    assert (rear.camera_model, rear.distortion_model, tuple(rear.D)) == ("fisheye", "equidistant", (0.0, 0.0, 0.0, 0.0))
    # The image is as wide as the field of view.
    assert rear.field_of_view_deg == pytest.approx(185.0)
    assert rear.K[0][0] == pytest.approx(16 / np.radians(92.5))
    np.testing.assert_array_equal(rear.X_RC[:3, 2].round(9), [-1, 0, 0])
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


def test_a_release_that_is_rendered_again_has_the_images_of_all_cameras(made, tmp_path, release_of, symolo):
    ended = symolo(
        "rerender", made, "--look", "lab", "--set", "robot.sensors.rear.period_s=0.2", "--out", tmp_path / "lab"
    )
    assert ended.code == 0, ended.err
    run = library.load(tmp_path / "lab")[RUN]
    assert {"": len(run.numbers), **{name: len(camera) for name, camera in run.cameras.items()}} == {
        **IMAGES,
        "rear": 4,
    }
    assert symolo("verify", tmp_path / "lab").code == 0
    stages = symolo("status", tmp_path / "lab").out
    assert "render left done, 5 images; render rear done, 4 images" in stages
    for name, before in library.load(made)[RUN].cameras.items():
        if name != "rear":
            np.testing.assert_array_equal(run.cameras[name].X_WC, before.X_WC)
    files = release_of(tmp_path / "lab")
    shutil.rmtree(tmp_path / "lab" / RUN / "cameras/left")
    assert symolo("repair", tmp_path / "lab").code == 0
    assert release_of(tmp_path / "lab") == files


def test_the_cameras_of_a_robot_see_what_a_log_recorded(tmp_path, symolo):
    robot, log = tmp_path / "pair.yaml", tmp_path / "log.csv"
    robot.write_text(
        "extends: nominal\nname: pair\nsensors:\n  imu: {}\n" + "".join(f"  {n}: {s}\n" for n, s in CAMERAS.items())
    )
    # A circle with a radius of 0.5 m at 1 rad/s, of which only places are known.
    angles = np.arange(0.0, 1.01, 0.1)
    rows = [f"{a:.1f},{0.5 * np.cos(a):.6f},{0.5 * np.sin(a):.6f},{a + np.pi / 2:.6f},7.4" for a in angles]
    log.write_text("t [s],x [m],y [m],theta [rad],battery [V]\n" + "\n".join(rows) + "\n")
    size = ("--set", "render.width_px=32", "--set", "render.height_px=24")
    ended = symolo("rerender", log, "--yes", "--robot", robot, "--look", "lab", *size, "--out", tmp_path / "out")
    assert ended.code == 0, ended.err
    assert symolo("verify", tmp_path / "out").code == 0
    (run,) = library.load(tmp_path / "out")
    assert {name: len(camera) for name, camera in run.cameras.items()} == {"left": 9, "rear": 4, "right": 9}
    (logged,) = run.sensors.values()  # the readings are those of the log, not of the robot
    assert set(logged.samples.iloc[:, -1]) == {7.4}
    for camera in run.cameras.values():
        truth = np.array([[0.5 * np.cos(t), 0.5 * np.sin(t), t + np.pi / 2] for t in camera.t_s])
        np.testing.assert_allclose(camera.table.pose, truth, atol=1e-3)


def test_only_a_camera_that_changed_is_rendered_again_and_the_rest_depends_on_no_camera(
    made, hands_of_module, copy_of, release_of, symolo, monkeypatch
):
    root, painted, paint = copy_of(made, stages=True), [], hands_of_module.paint
    monkeypatch.setattr(hands_of_module, "paint", lambda unit: (painted.append(unit.name), paint(unit)))
    assert symolo("release", "smoke", "--out", root, *options()).code == 0
    assert not painted
    assert symolo("release", "smoke", "--out", root, *options("robot.sensors.rear.fisheye.k1=0.01")).code == 0
    assert set(painted) == {f"{RUN} camera rear"}
    without = options(*(f"robot.sensors.{name}=null" for name in CAMERAS))
    assert symolo("release", "smoke", "--out", root, "--replace", *without).code == 0
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


def test_a_camera_has_any_rate_at_times_in_whole_milliseconds():
    """30 Hz: images after 0, 33.3, 66.7 and 100 ms."""
    spec = drawn("robot.sensors.rear.rate_hz=30")
    rear = next(camera for camera in cameras_of(spec) if camera.name == "rear")
    assert rear.period_s == pytest.approx(1 / 30)
    t_ms = np.array([0, 50, 100])
    still = Rows.from_table(np.column_stack((t_ms, np.zeros((3, 3)))), ("t", "x", "y", "theta"))
    assert rear.rows(still).t_ms.tolist() == [0, 33, 67, 100]


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ("{kind: camera, period_s: 0.1, rate_hz: 10}", "rear.rate_hz: got 10, allowed: either rate_hz or period_s"),
        ("{kind: camera, rate_hz: 2000}", "rear.rate_hz: got 2000, allowed: number >= 0.1 and <= 1000"),
        ("{kind: camera, fisheye: {k1: -1}}", r"sensors\.rear\.fisheye: the lens folds .* got 'k1 -1'"),
        ("{kind: camera, fisheye: null, distortion: {k1: -1}}", r"sensors\.rear\.distortion: the lens folds"),
        ("{kind: camera, fisheye: {}, distortion: {k1: 0.1}}", r"rear\.distortion: it is that of a pinhole camera"),
        ("{kind: camera, x_m: 0.9}", r"robot\.sensors\.rear.*0\.5"),
        ("{kind: camera, annotations: [depths]}", "did you mean depth"),
    ],
)
def test_an_impossible_camera_is_refused_before_anything_is_made(settings, message):
    with pytest.raises(InputError, match=message):
        drawn(f"robot.sensors.rear={settings}")


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (["robot.camera.fisheye={k1: -1}"], r"robot\.camera\.fisheye: the lens folds the image back .* got 'k1 -1"),
        (["robot.camera.fisheye={}", "robot.camera.distortion.k1=0.1"], r"distortion: it is that of a pinhole camera"),
        (
            [*HYBRID, "robot.sensors.left=null", "robot.sensors.right=null"],
            r"pinhole images: got 'hybrid', allowed: auto or full \(",
        ),
        ([*HYBRID, "robot.sensors.left.quality=draft", "robot.sensors.right=null"], r"allowed: auto or full \("),
    ],
)
def test_an_impossible_fisheye_lens_of_the_camera_of_data_csv_is_refused(settings, message):
    with pytest.raises(InputError, match=message):
        drawn(*settings)


def test_hybrid_rendering_is_for_the_cameras_without_a_fisheye_lens():
    methods = {c.name: rendering_of(c.spec.render, c.spec.robot.camera).method for c in cameras_of(drawn(*HYBRID))}
    assert methods == {"": "full", "left": "hybrid", "right": "hybrid", "rear": "full"}


def test_the_camera_of_data_csv_sees_through_a_fisheye_lens_what_a_further_one_sees():
    """Two cameras at one place, one of them that of data.csv: the jobs differ in the noise alone."""
    place = f"x_m: 0.05, pitch_up_deg: -30, rate_hz: 5, z_m: 0.12, fisheye: {{field_of_view_deg: 160}}, {SMALL}"
    spec = drawn("robot.camera.fisheye.field_of_view_deg=160", f"robot.sensors={{same: {{kind: camera, {place}}}}}")
    cameras = {camera.name: camera for camera in cameras_of(spec)}
    poses = [FramePose(k + 1, 0.2 * k, 0.55, -0.2, 0.1 * k) for k in range(60)]
    path = RobotPath(np.array([0.0, 20.0]), np.array([[0.55, -0.2, 0.0]] * 2), np.zeros((2, 2)))
    arena = Arena.from_config(spec.arena)
    jobs = [Appearance.from_spec(cameras[name].spec, "CPU", name).job(arena, poses, path) for name in ("", "same")]
    assert jobs[0].camera == jobs[1].camera
    assert jobs[0].camera.fisheye is not None
    X_WC = [np.array([view.X_WC for view in job.frames]) for job in jobs]
    np.testing.assert_allclose(X_WC[0], X_WC[1], atol=1e-12)
    assert (jobs[0].sampling.hybrid, jobs[0].sampling.probe) == (None, False)
    assert replace(jobs[0].sampling, seed=0) == replace(jobs[1].sampling, seed=0)


def test_a_release_through_a_fisheye_lens_is_verified_exported_and_read(hands, tmp_path, symolo):
    del hands
    root, out = tmp_path / "data", tmp_path / "out"
    wide = options("robot.camera.fisheye={}", "robot.sensors.left=null", "robot.sensors.right=null")
    assert symolo("release", "smoke", "--out", root, *wide).code == 0
    assert symolo("verify", root).out == f"{root}: no fault\n"
    camera = library.load(root)[RUN].camera
    assert (camera.camera_model, camera.field_of_view_deg) == ("fisheye", pytest.approx(185.0))
    assert camera.K[0][0] == pytest.approx(16 / np.radians(92.5))
    assert symolo("export", root, "--format", "tum,euroc,mcap,rerun", "--out", out).code == 0
    assert "distortion_model: equidistant" in next(out.glob("euroc/**/cam0/sensor.yaml")).read_text()
    for command in ("report", "view"):
        assert symolo(command, root, "--out", tmp_path / f"{command}.html").code == 0
    refused = symolo("identify-camera", root / RUN, "--out", tmp_path / "identified")
    assert (refused.code, "has a fisheye lens, and only pinhole cameras" in refused.err) == (2, True)


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
