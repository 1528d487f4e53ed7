"""Bags of ROS 2 by mcap's own reader, of ROS 1 by rosbags' one: both say what was put into the release."""

import json
from dataclasses import dataclass

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.rosbag1 import Reader
from rosbags.rosbag2 import Reader as Reader2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from symolo.dataset.tables.side_tables import WHEELS

SECOND = 1_000_000_000
MD5_OF_NOETIC = {
    "sensor_msgs/msg/CompressedImage": "8f7a12909da2c9d3332d540a0977563f",
    "sensor_msgs/msg/CameraInfo": "c9a58c1b0b154e0e6da7578cb991d214",
    "nav_msgs/msg/Odometry": "cd5e73d190d741a2f92e81eda573aca7",
    "sensor_msgs/msg/Range": "c005c34273dc426c67a020a87bc24148",
    "sensor_msgs/msg/JointState": "3066dcd76a6cfaef579bd0f34173e9fd",
    "geometry_msgs/msg/TwistStamped": "98d34b0043a2093cf9d9345ab6eef12e",
    "std_msgs/msg/Float64MultiArray": "4b7d974086d4060e7db4613a7e6c3ba4",
    "std_msgs/msg/Int32": "da5909fbe378aeaf85e547e830cc1bb7",
    "tf2_msgs/msg/TFMessage": "94810edda583a504dfda3829e70d7eec",
}
"""By which a node of ROS 1 knows that a bag's messages are its own; as `rosmsg md5` prints them."""


@dataclass(frozen=True)
class Bag:
    messages: dict[str, list]
    """By topic, as times [ns] and messages, in the order of the file."""
    ros: int


def read_mcap(path) -> Bag:
    found, times = {}, []
    with path.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        for _schema, channel, record, message in reader.iter_decoded_messages(log_time_order=False):
            found.setdefault(channel.topic, []).append((record.log_time, message))
            times.append(record.log_time)
    assert times == sorted(times)
    return Bag(found, 2)


def read_bag(path) -> Bag:
    store = get_typestore(Stores.ROS1_NOETIC)
    store.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", "tf2_msgs/msg/TFMessage"))
    found = {}
    with Reader(path) as reader:
        assert {one.msgtype: one.digest for one in reader.connections} == MD5_OF_NOETIC
        assert {one.topic for one in reader.connections if one.ext.latching} == {"/tf_static"}
        for connection, at_ns, raw in reader.messages():
            message = store.deserialize_ros1(raw, connection.msgtype)
            found.setdefault(connection.topic, []).append((at_ns, message))
    return Bag(found, 1)


def rotation(q) -> np.ndarray:
    """(3, 3) of a unit quaternion: Shoemake, Animating Rotation with Quaternion Curves, 1985."""
    x, y, z, w = q.x, q.y, q.z, q.w
    assert x * x + y * y + z * z + w * w == pytest.approx(1, abs=1e-12)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def matrix(transform) -> np.ndarray:
    X = np.eye(4)
    X[:3, :3] = rotation(transform.rotation)
    X[:3, 3] = transform.translation.x, transform.translation.y, transform.translation.z
    return X


def planar(x, y, theta) -> np.ndarray:
    c, s = np.cos(theta), np.sin(theta)
    return np.array([[c, -s, 0, x], [s, c, 0, y], [0, 0, 1, 0], [0, 0, 0, 1]])


def at_rows(bag, topic, truth, frame):
    """Messages of a topic that has one at each row, with right stamps and frame."""
    found = bag.messages[topic]
    expected = (SECOND + truth.table[:, 0] * 1_000_000).astype(np.int64).tolist()
    assert [at_ns for at_ns, _ in found] == expected
    messages = [message for _, message in found]
    if frame is not None:
        stamps = [(one.header.stamp.sec * SECOND + one.header.stamp.nanosec, one.header.frame_id) for one in messages]
        assert stamps == [(at_ns, frame) for at_ns in expected]
    return messages


def wheels(truth, *names):
    return np.column_stack([truth.wheels[:, WHEELS.header.index(name)] for name in names])


def transforms_differ(bag, truth, model, robot):
    ((at_ns, static),) = bag.messages["/tf_static"]
    assert at_ns == SECOND
    fixed = {(one.header.frame_id, one.child_frame_id): matrix(one.transform) for one in static.transforms}
    X_RC = fixed["base_link", "camera_link"] @ fixed["camera_link", "camera_optical_frame"]
    np.testing.assert_allclose(X_RC, model["X_RC"], rtol=0, atol=1e-8)
    # Of REP 103: the image's right is the body's right, which is -y, and its axis is x.
    np.testing.assert_allclose(
        fixed["camera_link", "camera_optical_frame"][:3, :3], [[0, 0, 1], [-1, 0, 0], [0, -1, 0]], atol=1e-12
    )
    half = np.sqrt(0.5)
    for name, ahead in (("front", [1, 0, 0]), ("left", [half, half, 0]), ("right", [half, -half, 0])):
        X = fixed["base_link", f"tof_{name}"]
        mount = robot["tof"]["mounts"][name]
        np.testing.assert_allclose(X[:3, 0], ahead, atol=1e-12)
        assert X[:3, 3].tolist() == [mount["x_m"], mount["y_m"], mount["z_m"]]
    assert fixed["base_link", "line_sensor"][0, 3] == robot["line_sensor"]["x_m"]
    assert len(fixed) == 6
    odometry = wheels(truth, "odometry_x", "odometry_y", "odometry_theta")
    for message, pose, wheel_pose in zip(at_rows(bag, "/tf", truth, None), truth.table[:, 1:4], odometry, strict=True):
        moving = {(one.header.frame_id, one.child_frame_id): matrix(one.transform) for one in message.transforms}
        assert {*moving} == {("map", "odom"), ("odom", "base_link")}
        np.testing.assert_allclose(moving["odom", "base_link"], planar(*wheel_pose), rtol=0, atol=1e-12)
        X_WR = moving["map", "odom"] @ moving["odom", "base_link"]
        np.testing.assert_allclose(X_WR, planar(*pose), rtol=0, atol=1e-12)


def check_odometry(bag, truth, robot):
    diameter_m, track_m = robot["drive"]["wheel_diameter_m"], robot["drive"]["track_m"]
    right, left = (wheels(truth, "speed_r", "speed_l") * diameter_m / 2).T
    odometry = wheels(truth, "odometry_x", "odometry_y", "odometry_theta")
    by_wheels = np.column_stack((odometry, (right + left) / 2, (right - left) / track_m))
    true = truth.table[:, [1, 2, 3, 5, 6]]
    for topic, frame, expected in (("/ground_truth/odom", "map", true), ("/odom", "odom", by_wheels)):
        for message, (x, y, theta, v, w) in zip(at_rows(bag, topic, truth, frame), expected, strict=True):
            assert message.child_frame_id == "base_link"
            place, twist = message.pose.pose.position, message.twist.twist
            assert (place.x, place.y, place.z) == (x, y, 0)
            np.testing.assert_allclose(rotation(message.pose.pose.orientation), planar(0, 0, theta)[:3, :3], atol=1e-12)
            np.testing.assert_allclose((twist.linear.x, twist.angular.z), (v, w), rtol=1e-12, atol=1e-15)
            assert (twist.linear.y, twist.linear.z, twist.angular.x, twist.angular.y) == (0, 0, 0, 0)


def readings_differ(bag, truth, robot):
    turn = 2 * np.pi / robot["encoder"]["counts_per_revolution"]
    counts, speeds = wheels(truth, "counts_r", "counts_l"), wheels(truth, "speed_r", "speed_l")
    for message, angle, speed in zip(at_rows(bag, "/joint_states", truth, ""), counts * turn, speeds, strict=True):
        assert list(message.name) == ["right_wheel_joint", "left_wheel_joint"]
        np.testing.assert_allclose(message.position, angle, rtol=1e-12)
        assert (list(message.velocity), len(message.effort)) == (speed.tolist(), 0)
    for message, (v, w) in zip(
        at_rows(bag, "/cmd_vel", truth, "base_link"), wheels(truth, "command_v", "command_w"), strict=True
    ):
        assert (message.twist.linear.x, message.twist.angular.z) == (v, w)
    for i, name in enumerate(("front", "left", "right")):
        expected = np.where(truth.tof[:, 1 + i] == 1, np.inf, truth.table[:, 7 + i])
        messages = at_rows(bag, f"/tof/{name}", truth, f"tof_{name}")
        assert [one.range for one in messages] == expected.astype(np.float32).tolist()
        tof, first = robot["tof"], messages[0]
        limits = [np.radians(tof["field_of_view_deg"]), tof["min_range_m"], tof["max_range_m"]]
        assert [first.field_of_view, first.min_range, first.max_range] == np.float32(limits).tolist()
        assert first.radiation_type == 1  # infrared
    lines = at_rows(bag, "/line_sensor", truth, None)
    np.testing.assert_array_equal([list(one.data) for one in lines], truth.table[:, 10:18])
    assert (lines[0].layout.dim[0].label, lines[0].layout.dim[0].size) == ("channel", 8)
    assert [one.data for one in at_rows(bag, "/state", truth, None)] == truth.table[:, 4].tolist()


def pictures_differ(bag, truth, model):
    taken = truth.table[:, 18] > 0
    stamps = (SECOND + truth.table[taken, 0] * 1_000_000).astype(np.int64).tolist()
    pictures, infos = bag.messages["/camera/image_raw/compressed"], bag.messages["/camera/camera_info"]
    assert [at_ns for at_ns, _ in pictures] == [at_ns for at_ns, _ in infos] == stamps
    assert tuple(bytes(one.data) for _, one in pictures) == truth.pictures
    assert {one.format for _, one in pictures} == {"jpeg"}
    for (at_ns, info), (_, picture) in zip(infos, pictures, strict=True):
        for header in (info.header, picture.header):
            assert (header.stamp.sec * SECOND + header.stamp.nanosec) == at_ns
            assert header.frame_id == "camera_optical_frame"
        names = "DKRP" if bag.ros == 1 else "dkrp"
        D, K, R, P = (np.array(getattr(info, name)) for name in names)
        assert (info.width, info.height, info.distortion_model) == (model["width_px"], model["height_px"], "plumb_bob")
        np.testing.assert_array_equal(K.reshape(3, 3), truth.K)
        np.testing.assert_array_equal(P.reshape(3, 4), np.column_stack((truth.K, np.zeros(3))))
        np.testing.assert_array_equal(R.reshape(3, 3), np.eye(3))
        assert D.tolist() == model["D"]


def test_bags_hold_the_release(seed, random_release, exported, tmp_path):
    release = random_release(seed)
    out = exported(release.root, tmp_path / "out", "mcap", "ros1")
    for truth in release.runs:
        side = release.root / truth.name / "side"
        model = json.loads((side / "intrinsics.json").read_text())
        robot = json.loads((side / "spec.json").read_text())["robot"]
        for bag in (read_mcap(out / f"mcap/{truth.name}.mcap"), read_bag(out / f"ros1/{truth.name}.bag")):
            assert len(bag.messages) == 13
            transforms_differ(bag, truth, model, robot)
            check_odometry(bag, truth, robot)
            readings_differ(bag, truth, robot)
            pictures_differ(bag, truth, model)


def test_who_comes_later_gets_the_fixed_transforms(random_release, exported, tmp_path):
    """As rosbags reads it, of which `ros2 bag play` takes the quality of service."""
    out = exported(random_release(1).root, tmp_path / "out", "mcap")
    with Reader2(out / "mcap/CW/test_1.mcap") as reader:
        durable = {
            one.topic
            for one in reader.connections
            for profile in one.ext.offered_qos_profiles
            if profile.durability.name == "TRANSIENT_LOCAL"
        }
    assert durable == {"/tf_static"}
