"""Laser scans and IMUs of bags that other writers made, against the numbers that were written."""

import math

import numpy as np
import pytest

from logs.trajectories import READERS
from logs.trajectories.base import ReadSettings
from symolo.core.geometry.poses import pose_X_WR, transform_of
from tests.logs.written_bags import POSE, START_NS, T_S, Ros, write_mcap, write_ros1

RAYS, STEP_RAD, RAY_S = 8, math.radians(40.0), 0.004
SCANS = 10
X_RL = transform_of((-0.03, 0.02, 0.18), (math.pi, 0.0, 0.5 * math.pi))
"""A scanner that hangs upside down and looks to the left."""
X_RI = transform_of((0.01, 0.0, 0.05), (0.0, math.radians(-30.0), 0.0))
"""An IMU whose x axis points upwards by 30 degrees."""


def ranges(number):
    """Returns, and what devices state in their place (REP 117): none, none as 0, a failure, too close, too far."""
    return [1.25 + 0.1 * number, math.inf, 0.0, math.nan, 0.05, 9.0, 2.5, 0.1234]


def scan(ros, at_ns, number, *, light=True, rays=RAYS):
    return ros(
        "sensor_msgs/LaserScan",
        header=ros.header(at_ns, "laser"),
        angle_min=-math.pi,
        angle_max=-math.pi + STEP_RAD * (rays - 1),
        angle_increment=STEP_RAD,
        time_increment=RAY_S,
        scan_time=0.2,
        range_min=0.1,
        range_max=8.0,
        ranges=np.array(ranges(number)[:rays], np.float32),
        intensities=np.arange(rays if light else 0, dtype=np.float32) + number,
    )


def imu(ros, at_ns, rate, *, has_acceleration=True):
    known = np.zeros(9)
    unknown = np.array([-1.0, *np.zeros(8)])
    return ros(
        "sensor_msgs/Imu",
        header=ros.header(at_ns, "imu_link"),
        orientation=ros("geometry_msgs/Quaternion", x=0.0, y=0.0, z=0.0, w=1.0),
        orientation_covariance=unknown,
        angular_velocity=ros("geometry_msgs/Vector3", x=0.1, y=-0.2, z=rate),
        angular_velocity_covariance=known,
        linear_acceleration=ros("geometry_msgs/Vector3", x=0.0, y=0.25, z=9.81),
        linear_acceleration_covariance=known if has_acceleration else unknown,
    )


def messages(ros, **parts):
    """Poses at 20 Hz, an IMU at 100 Hz, scans at 5 Hz; the scanner is on the turret, the turret on the robot."""
    links = [("base_link", "turret", pose_X_WR(-0.03, 0.02, 0.0)), ("base_link", "imu_link", X_RI)]
    links.append(("turret", "laser", np.linalg.inv(links[0][2]) @ X_RL))
    for parent, child, X in links if parts.pop("mounted", True) else ():
        yield START_NS, "/tf_static", ros.transform(START_NS, parent, child, X)
    for number, (t_s, pose) in enumerate(zip(T_S.tolist(), POSE.tolist(), strict=True)):
        at_ns = START_NS + round(1e9 * t_s)
        yield at_ns, "/tf", ros.transform(at_ns, "odom", "base_link", pose_X_WR(*pose))
        for k in range(5):
            later_ns = at_ns + 10_000_000 * k
            yield later_ns, "/imu/data", imu(ros, later_ns, 0.5 + 0.001 * number, **parts.get("imu", {}))
        if number % 4 == 0 and number < 4 * SCANS:
            yield at_ns, "/scan", scan(ros, at_ns, number // 4, **parts.get("scan", {}))


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
