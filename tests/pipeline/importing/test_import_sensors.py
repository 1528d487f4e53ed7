"""Bags of a release back through `symolo import`: cameras, lidar and IMU come back as they went."""

import json
import tarfile

import numpy as np
import pandas as pd
import pytest

import symolo as symolo_reader
from pipeline.cli import main
from pipeline.importing.imported_runs import ImportRequest
from pipeline.rerendering.rerender import RerenderRequest, prepare
from pipeline.rerendering.sources import read_sources
from tests.logs.test_bag_cameras import CENTER, COUNT, FOCAL, Camera, encoded, scene, written

RUN = "CW/test_1"
MISSING = 3
"""Number of the image that `one_camera` lacks."""


@pytest.fixture(scope="module")
def imported(sensing_release, tmp_path_factory):
    """The datasets of a bag of ROS 2 and of one of ROS 1 of the same run, by their formats."""
    folder = tmp_path_factory.mktemp("bags")
    assert main(["export", str(sensing_release), "--format", "mcap,ros1", "--out", str(folder / "bags")]) == 0
    for form, ending in (("mcap", "mcap"), ("ros1", "bag")):
        path = folder / f"bags/{form}/{RUN}.{ending}"
        assert main(["import", str(path), "--topic", "/ground_truth/odom", "--out", str(folder / form)]) == 0
    return {form: folder / form for form in ("mcap", "ros1")}


@pytest.fixture(scope="module")
def recorded(imported):
    return imported["ros1"]


@pytest.mark.parametrize("form", ["mcap", "ros1"])
def test_lidar_and_imu_come_back_as_they_went(form, imported, sensing_release, symolo):
    root = imported[form]
    assert symolo("verify", root).out.strip() == f"{root}: no fault"
    (run,), truth = symolo_reader.load(root), symolo_reader.load(sensing_release)[RUN]
    lidar, true_lidar = run.sensors["lidar"], truth.sensors["lidar"]
    np.testing.assert_array_equal(lidar.numbers, true_lidar.numbers)
    imu, true_imu = run.sensors["imu"], truth.sensors["imu"]
    np.testing.assert_array_equal(imu.numbers, true_imu.numbers[:, :7])  # the temperature has a topic of its own
    assert "sensors_imu_temperature_temperature_degc" in run.side("log")
    for sensor, expected in ((lidar, true_lidar), (imu, true_imu)):
        assert sensor.kind == expected.kind
        assert sensor.settings.period_s == expected.settings.period_s
        np.testing.assert_allclose(sensor.X_RS, expected.X_RS, atol=1e-6)
    known = json.loads((root / "imported/test_1/side/spec.json").read_text())["robot"]["sensors"]
    assert not {"noise_m", "dropout_probability"} & known["lidar"].keys()
    assert not {"accelerometer", "gyroscope"} & known["imu"].keys()


@pytest.mark.parametrize("name", ["camera", "left", "right", "rear"])
def test_images_of_all_cameras_come_back_as_they_went(name, recorded, sensing_release):
    (run,), truth = symolo_reader.load(recorded), symolo_reader.load(sensing_release)[RUN]
    camera, source = run.cameras["bag_camera" if name == "camera" else name], {"camera": truth, **truth.cameras}[name]
    assert [image.path.read_bytes() for image in camera] == [image.path.read_bytes() for image in source]
    assert [image.t_s for image in camera] == [image.t_s for image in source]
    np.testing.assert_allclose(camera.X_WC, source.X_WC, atol=1e-6)
    for field in ("camera_model", "distortion_model", "width_px", "height_px", "K", "D"):
        np.testing.assert_array_equal(getattr(camera.camera, field), getattr(source.camera, field))
    np.testing.assert_allclose(camera.camera.X_RC, source.camera.X_RC, atol=1e-6)
    if name == "rear":
        assert camera.camera.field_of_view_deg == pytest.approx(source.camera.field_of_view_deg, abs=1e-4)


def test_what_was_imported_is_exported_again(recorded, tmp_path, symolo):
    assert symolo("export", recorded, "--format", "ros1,euroc", "--out", tmp_path / "out").code == 0
    body = tmp_path / "out/euroc/imported/test_1/mav0"
    assert len([*(body / "cam0/data").iterdir()]) == len([*(body / "cam1/data").iterdir()]) == 4
    assert "left" in (body / "cam0/sensor.yaml").read_text()
    bag, back = tmp_path / "out/ros1/imported/test_1.bag", tmp_path / "back"
    assert symolo("import", bag, "--topic", "/ground_truth/odom", "--out", back).code == 0
    (first,), (second,) = symolo_reader.load(recorded), symolo_reader.load(back)
    for name in ("lidar", "imu"):
        np.testing.assert_array_equal(first.sensors[name].numbers, second.sensors[name].numbers)
    assert {*first.cameras} == {*second.cameras} == {"bag_camera", "left", "right", "rear"}


def test_nothing_says_that_recorded_images_were_rendered(recorded):
    metadata = json.loads((recorded / "metadata.json").read_text())
    assert "bpy" not in metadata["made_with"]
    (record,) = metadata["runs"]
    assert {camera["render_device"] for camera in record["cameras"].values()} == {""}
    text = (recorded / "README.md").read_text()
    assert "and so are the images of its cameras" in text
    assert "Blender" not in text


@pytest.mark.parametrize(
    ("path", "change", "message"),
    [
        ("side/camera.csv", lambda text: text.replace("\n2,200,", "\n2,0,"), "column t does not increase within"),
        ("side/camera.csv", lambda text: text.replace("\n2,200,", "\n2,201,"), "is not the pose of image 2"),
        ("side/intrinsics.json", lambda text: text.replace('"width_px": 32', '"width_px": 33'), "is of images of 33 x"),
        ("image_positions.txt", lambda text: text.replace("\n2 ", "\n7 "), "line 3: is not the pose of image 2"),
    ],
)
def test_verify_finds_damage_of_a_recorded_camera(path, change, message, recorded, copy_of, sign, symolo):
    root = copy_of(recorded)
    file = root / "imported/test_1/cameras/left" / path
    text = file.read_text()
    assert change(text) != text
    file.write_text(change(text))
    sign(root)
    ended = symolo("verify", root)
    assert (ended.code, message in ended.out) == (4, True), ended.out


def test_repair_takes_recorded_images_from_the_stages_and_writes_the_description_again(recorded, copy_of, symolo):
    root = copy_of(recorded, stages=True)
    (root / "README.md").unlink()
    (root / "imported/test_1/cameras/left/images/000002.jpg").write_bytes(b"damaged")
    ended = symolo("repair", root)
    assert (ended.code, symolo("verify", root).out.strip()) == (0, f"{root}: no fault"), ended.out


def test_images_after_the_last_row_are_left_out_in_one_sentence(tmp_path, symolo):
    def of_image(ros, at_ns, number):
        front = Camera(ros, "front")
        yield front.info(at_ns)
        for late_ns in (0, 600_000_000 if number == COUNT - 1 else 1):  # the second one is within a millisecond
            yield front.compressed(at_ns + late_ns, encoded(scene(number), ".jpg"))

    ended = symolo("import", written(tmp_path, 1, of_image), "--yes", "--out", tmp_path / "data")
    assert ended.code == 0, ended.err
    assert "front: left out: 6 images before the first or after the last row, or within a millisecond of" in ended.out
    (run,) = symolo_reader.load(tmp_path / "data")
    assert len(run.cameras["front"].images) == COUNT


@pytest.fixture(scope="module")
def one_camera(tmp_path_factory):
    """A dataset of a bag with one camera, whose images come at 2 Hz, some of them late and one not at all."""
    folder = tmp_path_factory.mktemp("camera")

    def of_image(ros, at_ns, number):
        front, late_ns = Camera(ros, "front"), (0, 30_000_000, 0, 0, 90_000_000, 0)[number]
        yield front.info(at_ns)
        if number != MISSING:
            yield front.compressed(at_ns + late_ns, encoded(scene(number), ".jpg"))

    bag = written(folder, 1, of_image)
    assert main(["import", str(bag), "--yes", "--out", str(folder / "data")]) == 0
    return folder / "data"


def test_recorded_images_are_exported_with_their_times_and_poses(one_camera, tmp_path, symolo):
    splits = "{runs: {train: [imported/*]}}"
    ended = symolo("export", one_camera, "--format", "kitti,webdataset", "--splits", splits, "--out", tmp_path / "out")
    assert (ended.code, "splits: train 1 run, 5 images" in ended.out) == (0, True), ended.out
    (run,) = symolo_reader.load(one_camera)
    camera = run.cameras["front"]
    files = [image.path.read_bytes() for image in camera]
    sequence = tmp_path / "out/kitti/sequences/00"
    assert [path.read_bytes() for path in sorted((sequence / "image_0").iterdir())] == files
    np.testing.assert_allclose(np.loadtxt(sequence / "times.txt"), camera.t_s, atol=1e-9)
    origin, poses = np.loadtxt(sequence / "origin.txt"), np.loadtxt(tmp_path / "out/kitti/poses/00.txt")
    X_WC0 = np.vstack([origin.reshape(3, 4), [0, 0, 0, 1]])
    X_WC = X_WC0 @ np.concatenate([poses.reshape(-1, 3, 4), np.tile([[[0, 0, 0, 1]]], (len(files), 1, 1))], axis=1)
    np.testing.assert_allclose(X_WC, camera.X_WC, atol=1e-8)
    K = np.array([[FOCAL[0], 0, CENTER[0], 0], [0, FOCAL[1], CENTER[1], 0], [0, 0, 1, 0]])
    calibration = dict(line.split(": ") for line in (sequence / "calib.txt").read_text().splitlines())
    np.testing.assert_allclose(np.array(calibration["P0"].split(), float).reshape(3, 4), K)
    with tarfile.open(tmp_path / "out/webdataset/cameras/front/symolo-train-000000.tar") as shard:
        names = shard.getnames()
        assert [shard.extractfile(name).read() for name in names if name.endswith(".jpg")] == files
        record = json.load(shard.extractfile(names[0].partition(".")[0] + ".json"))
    assert (record["run"], record["camera"], record["img"], record["d_f"]) == ("imported/test_1", "front", 1, None)


def test_frames_of_lerobot_are_evenly_spaced_and_have_the_nearest_recorded_image(one_camera, tmp_path, symolo):
    assert symolo("export", one_camera, "--format", "lerobot", "--out", tmp_path / "out").code == 0
    info = json.loads((tmp_path / "out/lerobot/meta/info.json").read_text())
    frames = pd.read_parquet(tmp_path / "out/lerobot/data")
    assert (info["fps"], info["total_frames"]) == (2, COUNT)
    np.testing.assert_array_equal(frames["timestamp"], 0.5 * np.arange(COUNT))
    images = symolo_reader.load(one_camera).runs[0].cameras["front"].images
    # Of the frame at 1.5 s, whose image is missing, the image before is nearer than the one after it, which is late.
    nearest = [0, 1, 2, 2, 3, 4]
    files = [image.path.read_bytes() for image in images]
    assert [one["bytes"] for one in frames["observation.images.front"]] == [files[index] for index in nearest]
    poses = np.array([images[index].pose for index in nearest], np.float32)
    np.testing.assert_array_equal(np.stack(frames["pose"]), poses)


@pytest.mark.parametrize("form", ["coco", "yolo"])
def test_recorded_images_have_no_labels_to_export(form, one_camera, tmp_path, symolo):
    ended = symolo("export", one_camera, "--format", form, "--out", tmp_path / "out")
    assert (ended.code, "were recorded, and nobody has labelled them; render labelled ones" in ended.err) == (2, True)


def test_rerender_replaces_recorded_cameras_by_rendered_ones(recorded):
    sources = read_sources([recorded], None, ImportRequest((recorded,)))
    (run,) = prepare(sources, RerenderRequest(("lab",), camera_hz=5)).runs
    assert {"left", "bag_camera"}.isdisjoint(run.spec.robot.sensors.names)
    assert sources.recorded_cameras == ("bag_camera", "left", "rear", "right")
    assert {"lidar", "imu"} <= {*run.spec.robot.sensors.names}
    assert not [path for path in run.side if path.startswith("cameras/")]
