"""Sensors of `robot.sensors` in the files of a robot, as yourdfpy and an XML parser read them."""

from math import cos, degrees, radians, sin, sqrt
from xml.etree import ElementTree as ET

import numpy as np
import pytest
import yourdfpy

from configs.draw import draw_run
from configs.loader import load_scenario
from pipeline.models.files import model_files

SENSORS = {
    "imu": "{x_m: -0.03, z_m: 0.06, yaw_deg: 90}",
    "lidar": "{z_m: 0.1, rays: 180, first_ray_deg: 90, ray_step_deg: -1}",
    "beside": "{kind: vl53l0x, y_m: 0.05, yaw_deg: 90, mode: long_range}",
    "sonar": "{kind: ultrasonic, x_m: 0.09}",
    "corners": "{kind: line_array, channels: 4}",
    "bumper": "{}",
    "coder": "{kind: wheel_encoder}",
    "left": "{kind: camera, x_m: 0.06, y_m: 0.03, pitch_up_deg: -25, width_px: 160, height_px: 120, period_s: 0.1}",
    "rear": "{kind: camera, x_m: -0.08, yaw_deg: 180, width_px: 64, height_px: 64, fisheye: {field_of_view_deg: 190}}",
}
PLACED = {*SENSORS} - {"coder"}


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    settings = [f"robot.sensors.{name}={value}" for name, value in SENSORS.items()]
    spec = draw_run(load_scenario("smoke", settings), "CW", 1)
    folder = tmp_path_factory.mktemp("sensing")
    for name, data in model_files(spec, ("urdf", "sdf")).items():
        (folder / name).write_bytes(data)
    return folder


@pytest.fixture(scope="module")
def sensors(files):
    root = ET.parse(files / "robot.sdf")  # noqa: S314 - a file that was written above
    return {sensor.get("name"): sensor for sensor in root.iter("sensor")}


def value(element, path):
    return float(element.findtext(path))


@pytest.mark.filterwarnings("ignore:.*dump.concatenate=True:DeprecationWarning")  # of trimesh, at yourdfpy's way
def test_each_sensor_with_a_place_is_a_link_of_the_urdf(files):
    robot = yourdfpy.URDF.load(str(files / "robot.urdf"))
    assert robot.validate()
    further = {name for name in robot.link_map if name.startswith("sensors/")}
    optical = {f"sensors/{name}/optical_frame" for name in ("left", "rear")}
    assert further == {f"sensors/{name}" for name in PLACED} | optical
    X_RS = robot.get_transform("sensors/imu", "base_link")
    np.testing.assert_allclose(X_RS, [[0, -1, 0, -0.03], [1, 0, 0, 0], [0, 0, 1, 0.06], [0, 0, 0, 1]], atol=1e-9)
    X_RC = robot.get_transform("sensors/left/optical_frame", "base_link")
    down = radians(25)
    np.testing.assert_allclose(X_RC[:3, 2], [cos(down), 0, -sin(down)], atol=1e-9)  # along the axis
    np.testing.assert_allclose(X_RC[:3, 0], [0, -1, 0], atol=1e-9)  # to the right
    np.testing.assert_allclose(X_RC[:3, 3], [0.06, 0.03, 0.12], atol=1e-9)


def test_the_sdf_has_the_sensors_that_it_can_describe(sensors):
    kinds = {name: sensor.get("type") for name, sensor in sensors.items() if name.startswith("sensors/")}
    assert kinds == {
        "sensors/imu": "imu",
        "sensors/lidar": "gpu_lidar",
        "sensors/beside": "gpu_lidar",
        "sensors/sonar": "gpu_lidar",
        "sensors/left": "camera",
        "sensors/rear": "wideanglecamera",
    }
    rates_hz = {"imu": 200, "lidar": 10, "sonar": 1 / 0.06, "left": 10, "rear": 5}
    for name, rate_hz in rates_hz.items():
        assert value(sensors[f"sensors/{name}"], "update_rate") == pytest.approx(rate_hz)


def test_their_numbers_are_those_of_the_robot(sensors):
    scan = sensors["sensors/lidar"].find("lidar/scan/horizontal")
    assert value(scan, "samples") == 180
    # The head turns clockwise from 90 to -89 degrees; SDF counts from the smaller angle.
    angles_deg = [degrees(value(scan, f"{end}_angle")) for end in ("min", "max")]
    assert angles_deg == pytest.approx([-89, 90])
    # White noise of a mean over 5 ms, with the density of the default.
    noise = value(sensors["sensors/imu"], "imu/angular_velocity/z/noise/stddev")
    assert noise == pytest.approx(8.7e-5 / sqrt(0.005), rel=1e-5)
    assert value(sensors["sensors/beside"], "lidar/range/max") == 2.0
    assert value(sensors["sensors/sonar"], "lidar/range/max") == 4.0
    lens = sensors["sensors/left"].find("camera")
    focal_px = 160 * 30 / 42.33  # the default lens
    assert value(lens, "lens/intrinsics/fx") == pytest.approx(focal_px)
    assert lens.findtext("optical_frame_id") == "sensors/left/optical_frame"
    wide = sensors["sensors/rear"].find("camera")
    assert degrees(value(wide, "horizontal_fov")) == pytest.approx(190)
    assert wide.findtext("lens/type") == "equidistant"
    pose = [float(one) for one in sensors["sensors/rear"].findtext("pose").split()]
    assert pose[:3] == [-0.08, 0.0, 0.12]
    assert abs(pose[5]) == pytest.approx(np.pi)


def test_the_world_loads_the_system_of_imus_only_for_a_robot_with_one(files, models):
    assert "gz-sim-imu-system" in (files / "world.sdf").read_text()
    assert "gz-sim-imu-system" not in (models / "world.sdf").read_text()
