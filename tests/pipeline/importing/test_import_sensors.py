"""Bags of a release back through `symolo import`: cameras, lidar and IMU come back as they went."""

import json

import numpy as np
import pytest

import symolo as symolo_reader
from pipeline.cli import main
from pipeline.importing.imported_runs import ImportRequest
from pipeline.rerendering.rerender import RerenderRequest, prepare
from pipeline.rerendering.sources import read_sources
from tests.logs.test_bag_cameras import COUNT, Camera, encoded, scene, written

RUN = "CW/test_1"


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
        assert getattr(camera.camera, field) == getattr(source.camera, field)
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


def test_rerender_replaces_recorded_cameras_by_rendered_ones(recorded):
    sources = read_sources([recorded], None, ImportRequest((recorded,)))
    (run,) = prepare(sources, RerenderRequest(("lab",), camera_hz=5)).runs
    assert {"left", "bag_camera"}.isdisjoint(run.spec.robot.sensors.names)
    assert {"lidar", "imu"} <= {*run.spec.robot.sensors.names}
    assert not [path for path in run.side if path.startswith("cameras/")]
