"""Bags of a release back through `symolo import`: lidar and IMU come back as they went."""

import json

import numpy as np
import pytest

import symolo as symolo_reader
from pipeline.cli import main

RUN = "CW/test_1"


@pytest.fixture(scope="module")
def bags(sensing_release, tmp_path_factory):
    out = tmp_path_factory.mktemp("bags") / "out"
    assert main(["export", str(sensing_release), "--format", "mcap,ros1", "--out", str(out)]) == 0
    return out


@pytest.mark.parametrize(("folder", "ending"), [("mcap", "mcap"), ("ros1", "bag")])
def test_lidar_and_imu_come_back_as_they_went(folder, ending, bags, sensing_release, tmp_path, symolo):
    root = tmp_path / "data"
    ended = symolo("import", bags / f"{folder}/{RUN}.{ending}", "--topic", "/ground_truth/odom", "--out", root)
    assert ended.code == 0, ended.err
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


def test_scans_and_imu_of_a_log_are_exported_again(bags, tmp_path, symolo):
    root = tmp_path / "data"
    assert symolo("import", bags / f"mcap/{RUN}.mcap", "--topic", "/ground_truth/odom", "--out", root).code == 0
    assert symolo("export", root, "--format", "ros1", "--out", tmp_path / "exported").code == 0
    (again,) = (tmp_path / "exported/ros1").rglob("*.bag")
    back = tmp_path / "back"
    assert symolo("import", again, "--topic", "/ground_truth/odom", "--out", back).code == 0
    (first,), (second,) = symolo_reader.load(root), symolo_reader.load(back)
    for name in ("lidar", "imu"):
        np.testing.assert_array_equal(first.sensors[name].numbers, second.sensors[name].numbers)
