"""Laser scans and IMUs of bags that other writers made, against the numbers that were written."""

import math

import numpy as np
import pytest

from logs.trajectories.base import ReadSettings
from logs.trajectories.readers import READERS
from symolo.core.geometry.poses import pose_X_WR
from tests.logs.sensor_messages import RAY_S, RAYS, SCANS, messages, scan
from tests.logs.written_bags import START_NS, T_S, Ros, write_mcap, write_ros1


def read(folder, version=1, *further, **parts):
    ros, path = Ros(version), folder / ("drive.bag" if version == 1 else "drive.mcap")
    (write_ros1 if version == 1 else write_mcap)(path, [*messages(ros, **parts), *(one(ros) for one in further)], ros)
    reader = next(reader for reader in READERS if reader.recognises(path))
    (trajectory,) = reader.read(path, ReadSettings(topics=("odom:base_link",)))
    return trajectory, {sensor.name: sensor for sensor in trajectory.sensors}


@pytest.fixture(scope="module", params=[1, 2], ids=["ROS 1", "ROS 2"])
def drive(request, tmp_path_factory):
    return read(tmp_path_factory.mktemp("bag"), request.param)


def test_scans_have_their_rays_and_the_time_of_the_last_one(drive):
    trajectory, sensors = drive
    lidar = sensors["scan"]
    assert (lidar.kind, trajectory.quantities["scan"]) == ("lidar", "/scan: 10 scans")
    expected = [[1.25 + 0.1 * n, 0.0, 0.0, math.nan, math.nan, 0.0, 2.5, 0.1234] for n in range(SCANS)]
    np.testing.assert_allclose(lidar.values[:, :RAYS], expected, rtol=1e-7)  # floats of 32 bits
    np.testing.assert_array_equal(lidar.values[:, RAYS:], np.add.outer(np.arange(SCANS), np.arange(RAYS)))
    range_column, light_column = lidar.columns
    assert (range_column.decimals, range_column.count, light_column.decimals) == (4, RAYS, 0)
    np.testing.assert_allclose(lidar.t_s - trajectory.t_s[0], 0.2 * np.arange(SCANS) + 7 * RAY_S, atol=1e-6)
    names = ("period_s", "sweep_s", "rays", "first_ray_deg", "ray_step_deg", "min_range_m", "max_range_m")
    assert [lidar.settings[name] for name in names] == pytest.approx([0.2, 8 * RAY_S, RAYS, -180, 40, 0.1, 8.0])


def test_an_imu_keeps_its_own_rate(drive):
    trajectory, sensors = drive
    imu_samples = sensors["imu_data"]
    assert imu_samples.kind == "imu"
    np.testing.assert_allclose(imu_samples.t_s - trajectory.t_s[0], 0.01 * np.arange(5 * len(T_S)), atol=1e-6)
    rate = 0.5 + 0.001 * np.repeat(np.arange(len(T_S)), 5)
    np.testing.assert_allclose(imu_samples.values[:, 5], rate, rtol=1e-12)
    np.testing.assert_allclose(imu_samples.values[:, :5] - [0.0, 0.25, 9.81, 0.1, -0.2], 0.0, atol=1e-12)
    assert [column.name for column in imu_samples.columns] == [
        f"{one}_{axis}" for one in ("acc", "gyro") for axis in "xyz"
    ]
    assert imu_samples.settings["period_s"] == pytest.approx(0.01)


def test_places_on_the_robot_are_those_of_the_transforms(drive):
    _, sensors = drive
    mount = sensors["scan"].settings
    assert [mount[name] for name in ("x_m", "y_m", "z_m")] == pytest.approx([-0.03, 0.02, 0.18])
    assert mount["yaw_deg"] == pytest.approx(90.0)
    assert abs(mount["roll_deg"]) == pytest.approx(180.0)
    assert sensors["imu_data"].settings["pitch_up_deg"] == pytest.approx(30.0)


def test_what_is_not_known_is_absent_and_named(tmp_path):
    trajectory, sensors = read(tmp_path, mounted=False, scan={"light": False}, imu={"has_acceleration": False})
    assert [column.name for column in sensors["scan"].columns] == ["range"]
    assert "x_m" not in sensors["scan"].settings
    assert np.isnan(sensors["imu_data"].values[:, :3]).all()
    notes = [text for text in trajectory.changes if "is not known" in text]
    assert notes == [
        f"{name}: no transform leads from base_link to {frame}, so its place on the robot is not known"
        for name, frame in (("imu_data", "imu_link"), ("scan", "laser"))
    ]


def test_scans_with_other_rays_than_most_are_left_out_in_one_sentence(tmp_path):
    late_ns = START_NS + 2_500_000_000
    trajectory, sensors = read(tmp_path, 1, lambda ros: (late_ns, "/scan", scan(ros, late_ns, 0, rays=5)))
    assert len(sensors["scan"].t_s) == SCANS
    assert "left out: 1 message of /scan with another number of rays or another frame" in trajectory.changes


def test_scans_that_begin_at_other_angles_are_not_taken(tmp_path):
    def turned(ros):
        late_ns = START_NS + 2_500_000_000
        message = scan(ros, late_ns, 0)
        message.angle_min = 0.0
        return late_ns, "/scan", message

    trajectory, sensors = read(tmp_path, 1, turned)
    assert "scan" not in sensors
    assert any(text.startswith("left out: /scan: its scans begin at different angles") for text in trajectory.changes)


def test_a_sensor_that_moves_on_the_robot_has_no_place(tmp_path):
    def turned(seconds, yaw_rad):
        late_ns = START_NS + round(1e9 * seconds)
        X = pose_X_WR(-0.03, 0.02, yaw_rad)
        return lambda ros: (late_ns, "/tf", ros.transform(late_ns, "base_link", "turret", X))

    trajectory, sensors = read(tmp_path, 1, turned(1.5, 0.0), turned(2.0, 0.3))
    assert "x_m" not in sensors["scan"].settings
    assert "x_m" in sensors["imu_data"].settings
    assert "scan: laser moves on the robot, so its place on the robot is not known" in trajectory.changes
