"""The layout of EuRoC, read with numpy, yaml and OpenCV, against the tables of the release."""

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml

import symolo
from logs.axis import Axis
from logs.trajectories.base import ReadSettings
from logs.trajectories.euroc import READER

START_NS = 10**18
RUN = "CW/test_1"
STATE, MARKER = "state_groundtruth_estimate0", "mocap0"
COLUMNS = {
    # As the ground truth of MH_01_easy has them.
    STATE: "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z [],"
    "v_RS_R_x [m s^-1],v_RS_R_y [m s^-1],v_RS_R_z [m s^-1],b_w_RS_S_x [rad s^-1],b_w_RS_S_y [rad s^-1],"
    "b_w_RS_S_z [rad s^-1],b_a_RS_S_x [m s^-2],b_a_RS_S_y [m s^-2],b_a_RS_S_z [m s^-2]",
    "imu0": "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x [m s^-2],"
    "a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]",
    "cam0": "#timestamp [ns],filename",
}


@dataclass(frozen=True)
class Layout:
    folder: Path

    def sensor(self, name):
        return yaml.safe_load((self.folder / name / "sensor.yaml").read_text())

    def X_BS(self, name):
        pose = self.sensor(name)["T_BS"]
        return np.array(pose["data"]).reshape(pose["rows"], pose["cols"])

    def table(self, name):
        """Stamps (N,) [ns] as integers, and the other columns as text (N, columns)."""
        head, *lines = (self.folder / name / "data.csv").read_text().splitlines()
        assert name not in COLUMNS or head == COLUMNS[name]
        cells = np.array([line.split(",") for line in lines])
        return np.array([int(cell) for cell in cells[:, 0]]), cells[:, 1:]

    def poses(self, name):
        """Stamps (N,) [ns] and poses (N, 4, 4)."""
        stamps, cells = self.table(name)
        numbers = cells.astype(float)
        X = np.tile(np.eye(4), (len(numbers), 1, 1))
        X[:, :3, :3] = [rotation(*q) for q in numbers[:, 3:7]]
        X[:, :3, 3] = numbers[:, :3]
        return stamps, X

    @property
    def cameras(self):
        return sorted(path.name for path in self.folder.glob("cam*"))


def rotation(w, x, y, z):
    """(3, 3) by Rodrigues' formula as OpenCV has it."""
    axis = np.array([x, y, z])
    sine = np.linalg.norm(axis)
    return cv2.Rodrigues(2 * np.arctan2(sine, w) * axis / sine if sine else axis)[0]


def planar(pose):
    x, y, theta = pose
    c, s = np.cos(theta), np.sin(theta)
    return np.array([[c, -s, 0, x], [s, c, 0, y], [0, 0, 1, 0], [0, 0, 0, 1]])


@pytest.fixture(scope="module")
def layout(sensing_release, exported, tmp_path_factory):
    out = exported(sensing_release, tmp_path_factory.mktemp("euroc") / "out", "euroc")
    return Layout(out / "euroc" / RUN / "mav0")


def csv(sensing_release, place):
    return np.genfromtxt(sensing_release / RUN / place, delimiter=",", names=True)


def camera_differs(layout, name, X_WC, files, model):
    """Poses, intrinsics, stamps and pixels of a camera; X_WC (N, 4, 4) are those of the release."""
    stamps, cells = layout.table(name)
    described = layout.sensor(name)
    assert described["resolution"] == [model.width_px, model.height_px]
    (fx, _, cx), (_, fy, cy), _ = model.K
    np.testing.assert_allclose(described["intrinsics"], [fx, fy, cx, cy], rtol=1e-8)
    np.testing.assert_allclose(described["distortion_coefficients"], model.D[:4], rtol=1e-8)
    true_ns, X_WB = layout.poses(STATE)
    at = np.searchsorted(true_ns, stamps)
    np.testing.assert_array_equal(true_ns[at], stamps)
    for pose, expected, (place,), file, stamp in zip(X_WB[at], X_WC, cells, files, stamps, strict=True):
        np.testing.assert_allclose(pose @ layout.X_BS(name), expected, rtol=0, atol=2e-6)
        assert place == f"{stamp}.png"
        grey = cv2.imread(str(layout.folder / name / "data" / place), cv2.IMREAD_UNCHANGED)
        blue, green, red = np.moveaxis(
            cv2.imdecode(np.frombuffer(file, np.uint8), cv2.IMREAD_COLOR).astype(float), 2, 0
        )
        # Rec. 601; OpenCV rounds weights to 14 bits.
        np.testing.assert_allclose(grey, 0.299 * red + 0.587 * green + 0.114 * blue, atol=0.6)


def test_a_robot_without_imu_is_the_body(seed, random_release, exported, tmp_path):
    release = random_release(seed)
    out = exported(release.root, tmp_path / "out", "euroc")
    for truth in release.runs:
        layout = Layout(out / "euroc" / truth.name / "mav0")
        assert layout.cameras == ["cam0"]
        assert not (layout.folder / "imu0").exists()
        for name in (STATE, MARKER):
            stamps, X_WB = layout.poses(name)
            assert stamps.tolist() == [START_NS + int(t_ms) * 1_000_000 for t_ms in truth.table[:, 0]]
            np.testing.assert_allclose(X_WB, [planar(pose) for pose in truth.table[:, 1:4]], rtol=0, atol=1e-8)
            np.testing.assert_array_equal(layout.X_BS(name), np.eye(4))
        velocity = layout.table(STATE)[1][:, 7:10].astype(float)
        theta, v = truth.table[:, 3], truth.table[:, 5]
        expected = np.column_stack((v * np.cos(theta), v * np.sin(theta), np.zeros(len(v))))
        np.testing.assert_allclose(velocity, expected, rtol=0, atol=1e-8)
        stamps, cells = layout.table("cam0")
        assert stamps.tolist() == [START_NS + int(row[0]) * 1_000_000 for row in truth.table if row[18] > 0]
        sizes = {cv2.imread(str(layout.folder / "cam0/data" / place), -1).shape for (place,) in cells}
        assert sizes == {(24, 40)}


def test_the_pair_is_first_and_each_camera_has_its_calibration(layout, sensing_release):
    assert layout.cameras == ["cam0", "cam1", "cam2", "cam3"]
    names = [layout.sensor(name)["comment"] for name in layout.cameras]
    assert names == ["left", "right", "camera", "rear"]
    run = symolo.load(sensing_release)[RUN]
    cameras = run.cameras["left"], run.cameras["right"], run, run.cameras["rear"]
    for name, camera in zip(layout.cameras, cameras, strict=True):
        files = [image.path.read_bytes() for image in camera.images]
        camera_differs(layout, name, camera.X_WC, files, camera.camera)
    assert layout.sensor("cam0")["distortion_model"] == "radial-tangential"
    assert (layout.sensor("cam3")["distortion_model"], layout.sensor("cam3")["rate_hz"]) == (
        "equidistant",
        pytest.approx(1 / 0.3),
    )
    # The right camera is 60 mm to the right in the axes of the left one.
    between = np.linalg.inv(layout.X_BS("cam0")) @ layout.X_BS("cam1")
    np.testing.assert_allclose(between, [[1, 0, 0, 0.06], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]], atol=1e-8)


def test_the_body_is_the_imu(layout, sensing_release):
    np.testing.assert_array_equal(layout.X_BS("imu0"), np.eye(4))
    described = layout.sensor("imu0")
    # The defaults of the sensor, which are those of an MPU-6050.
    assert (described["rate_hz"], described["gyroscope_noise_density"]) == (200, 8.7e-5)
    assert (described["gyroscope_random_walk"], described["accelerometer_noise_density"]) == (1e-6, 3.9e-3)
    assert described["accelerometer_random_walk"] == 1e-5
    imu, (stamps, cells) = csv(sensing_release, "side/imu.csv"), layout.table("imu0")
    assert stamps.tolist() == [START_NS + round(t_ms * 1e6) for t_ms in imu["t"]]
    names = [f"{kind}_{axis}" for kind in ("gyro", "acc") for axis in "xyz"]
    np.testing.assert_array_equal(cells.astype(float), np.column_stack([imu[name] for name in names]))
    stamps, X_WB = layout.poses(STATE)
    marker_ns, X_WR = layout.poses(MARKER)
    np.testing.assert_array_equal(stamps, marker_ns)
    assert {*np.diff(stamps).tolist()} == {50_000_000}  # images at 0.3 s are at rows, too
    np.testing.assert_allclose(X_WB @ layout.X_BS(MARKER), X_WR, rtol=0, atol=1e-8)
    # The IMU is behind the axle, on the left, turned to the left.
    X_RB = [[0, -1, 0, -0.03], [1, 0, 0, 0.02], [0, 0, 1, 0.06], [0, 0, 0, 1]]
    np.testing.assert_allclose(np.linalg.inv(X_WR[0]) @ X_WB[0], X_RB, atol=1e-6)


def test_the_velocity_is_the_slope_of_the_place(layout):
    stamps, cells = layout.table(STATE)
    place, velocity = cells[:, :3].astype(float), cells[:, 7:10].astype(float)
    slope = np.diff(place, axis=0) / (1e-9 * np.diff(stamps))[:, None]
    mean = [(before + after) / 2 for before, after in pairwise(velocity)]
    # The path of a row is not straight, and the robot starts to move within the first one.
    np.testing.assert_allclose(slope[2:], mean[2:], atol=0.02)


def test_import_reads_the_truth_back(layout, sensing_release):
    """By the reader of `symolo import`: R from mocap0, and otherwise the IMU, which is turned to the left."""
    rows = csv(sensing_release, "data.csv")
    (robot,) = READER.read(layout.folder / MARKER, ReadSettings(up=Axis.Z, forward=Axis.X))
    np.testing.assert_allclose(robot.t_s, rows["t"] / 1000, atol=1e-9)
    np.testing.assert_allclose(robot.pose[:, :2], np.column_stack((rows["x"], rows["y"])), atol=1e-6)
    np.testing.assert_allclose(robot.pose[:, 2], rows["theta"], atol=1e-6)
    assert READER.recognises(layout.folder.parent)
    (imu,) = READER.read(layout.folder.parent, ReadSettings(up=Axis.Z, forward=Axis.MINUS_Y))
    _, X_WB = layout.poses(STATE)
    np.testing.assert_allclose(imu.pose[:, :2], X_WB[:, :2, 3], atol=1e-6)
