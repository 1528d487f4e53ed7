"""Sensors and further cameras in bags, as readers of MCAP and of ROS 1 see them, against the tables of the release."""

import json

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.rosbag1 import Reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

SECOND = 1_000_000_000
RUN = "CW/test_1"
TYPES = {
    "imu": "sensor_msgs/Imu",
    "imu/temperature": "sensor_msgs/Temperature",
    "lidar": "sensor_msgs/LaserScan",
    "beside": "sensor_msgs/Range",
    "sonar": "sensor_msgs/Range",
    "corners": "std_msgs/Float64MultiArray",
    "coder": "sensor_msgs/JointState",
    "bumper": "std_msgs/Float64MultiArray",
    "left/camera_info": "sensor_msgs/CameraInfo",
    "left/image_raw/compressed": "sensor_msgs/CompressedImage",
    "right/camera_info": "sensor_msgs/CameraInfo",
    "right/image_raw/compressed": "sensor_msgs/CompressedImage",
    "rear/camera_info": "sensor_msgs/CameraInfo",
    "rear/image_raw/compressed": "sensor_msgs/CompressedImage",
}
MD5_OF_NOETIC = {
    "sensor_msgs/msg/Imu": "6a62c6daae103f4ff57a132d6f95cec2",
    "sensor_msgs/msg/LaserScan": "90c7ef2dc6895d81024acba2ac42f369",
    "sensor_msgs/msg/Temperature": "ff71b307acdbe7c871a5a6d7ed359100",
}
"""As `rosmsg md5` prints them."""


def read_mcap(path):
    messages, types = {}, {}
    with path.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        for schema, channel, record, message in reader.iter_decoded_messages(log_time_order=False):
            types[channel.topic] = schema.name.replace("/msg/", "/")
            messages.setdefault(channel.topic, []).append((record.log_time, message))
    return messages, types


def read_bag(path):
    store = get_typestore(Stores.ROS1_NOETIC)
    store.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", "tf2_msgs/msg/TFMessage"))
    messages, types = {}, {}
    with Reader(path) as reader:
        digests = {one.msgtype: one.digest for one in reader.connections}
        assert {name: digests[name] for name in MD5_OF_NOETIC} == MD5_OF_NOETIC
        for connection, at_ns, raw in reader.messages():
            types[connection.topic] = connection.msgtype.replace("/msg/", "/")
            message = store.deserialize_ros1(raw, connection.msgtype)
            messages.setdefault(connection.topic, []).append((at_ns, message))
    return messages, types


@pytest.fixture(scope="module", params=["mcap", "ros1"])
def bag(request, sensing_release, exported, tmp_path_factory):
    """Messages and types by topic."""
    out = exported(sensing_release, tmp_path_factory.mktemp(request.param) / "out", request.param)
    if request.param == "mcap":
        return read_mcap(out / f"mcap/{RUN}.mcap")
    return read_bag(out / f"ros1/{RUN}.bag")


@pytest.fixture(scope="module")
def table(sensing_release):
    """Columns of a table by name, as numpy reads the file."""
    return lambda name: np.genfromtxt(sensing_release / RUN / f"side/{name}.csv", delimiter=",", names=True)


def stamp_ns(message):
    return message.header.stamp.sec * SECOND + message.header.stamp.nanosec


def stamped(bag, name, t_ms, delay_ms=0.0, early_ms=0.0, frame=None):
    """Messages of a sensor, whose stamps and times in the bag are checked."""
    found = bag[0][f"/sensors/{name}"]
    assert [at_ns for at_ns, _ in found] == (SECOND + np.rint(1e6 * (t_ms + delay_ms))).astype(np.int64).tolist()
    messages = [message for _, message in found]
    np.testing.assert_allclose([stamp_ns(one) for one in messages], SECOND + 1e6 * (t_ms - early_ms), atol=1)
    assert {one.header.frame_id for one in messages} == {f"sensors/{name.split('/')[0]}" if frame is None else frame}
    return messages


def test_each_sensor_has_a_topic_of_its_type(bag):
    types = {topic: kind for topic, kind in bag[1].items() if topic.startswith("/sensors/")}
    assert types == {f"/sensors/{name}": kind for name, kind in TYPES.items()}
    assert {"/camera/camera_info", "/tf_static", "/line_sensor"} <= bag[1].keys()


def test_imu(bag, table):
    imu = table("imu")
    messages = stamped(bag, "imu", imu["t"])
    assert len(messages) == 121  # 0.6 s at 200 Hz, and the start
    for field, columns in (("linear_acceleration", "acc"), ("angular_velocity", "gyro")):
        readings = [[getattr(getattr(one, field), axis) for axis in "xyz"] for one in messages]
        np.testing.assert_array_equal(readings, np.column_stack([imu[f"{columns}_{axis}"] for axis in "xyz"]))
    # A mean over a period of 5 ms of white noise with the density n has the variance n^2 / 5 ms.
    first = messages[0]
    np.testing.assert_allclose(first.angular_velocity_covariance, (8.7e-5**2 / 0.005 * np.eye(3)).ravel(), rtol=1e-9)
    np.testing.assert_allclose(first.linear_acceleration_covariance, (3.9e-3**2 / 0.005 * np.eye(3)).ravel(), rtol=1e-9)
    assert first.orientation_covariance[0] == -1  # as the definition of the message has it for no orientation
    warm = stamped(bag, "imu/temperature", imu["t"], frame="sensors/imu")
    assert [one.temperature for one in warm] == imu["temperature"].tolist()


def test_scans_have_the_time_of_their_first_ray_and_infinity_where_nothing_returns(bag, table):
    lidar = table("lidar")
    # The last of 36 rays is measured at t, and the head turns in 0.1 s.
    messages = stamped(bag, "lidar", lidar["t"], delay_ms=20, early_ms=100 * 35 / 36)
    for number, one in enumerate(messages):
        assert one.angle_min == pytest.approx(-np.pi)
        assert one.angle_max == pytest.approx(np.radians(170))
        assert one.angle_increment == pytest.approx(np.radians(10))
        assert (one.time_increment, one.scan_time) == (pytest.approx(0.1 / 36), pytest.approx(0.1))
        assert (one.range_min, one.range_max) == (pytest.approx(0.05), 8.0)
        for i in range(36):
            range_m = lidar[f"range_{i}"][number]
            assert one.ranges[i] == (np.float32(range_m) if range_m > 0 else np.inf)
            assert one.intensities[i] == np.float32(lidar[f"intensity_{i}"][number])


def test_range_sensors(bag, table):
    beside, sonar = table("beside"), table("sonar")
    far = np.where(beside["status"] == 1, np.inf, beside["range"])
    messages = stamped(bag, "beside", beside["t"])
    assert [one.range for one in messages] == far.astype(np.float32).tolist()
    first = messages[0]
    assert (first.radiation_type, first.field_of_view, first.max_range) == (1, pytest.approx(np.radians(25)), 2.0)
    messages = stamped(bag, "sonar", sonar["t"])
    expected = np.where(sonar["range"] > 0, sonar["range"], np.inf)
    assert [one.range for one in messages] == expected.astype(np.float32).tolist()
    first = messages[0]
    assert (first.radiation_type, first.field_of_view) == (0, pytest.approx(np.radians(30)))
    assert (first.min_range, first.max_range) == (pytest.approx(0.02), 4.0)


def test_arrays_and_encoders(bag, table):
    for name, column in (("corners", "reflectance"), ("bumper", "pressed")):
        readings, found = table(name), bag[0][f"/sensors/{name}"]
        assert [at_ns for at_ns, _ in found] == (SECOND + np.rint(1e6 * readings["t"])).astype(np.int64).tolist()
        values = np.column_stack([readings[f"{column}_{i}"] for i in range(3)])
        np.testing.assert_array_equal([list(one.data) for _, one in found], values)
        assert found[0][1].layout.dim[0].size == 3
    coder = table("coder")
    messages = stamped(bag, "coder", coder["t"], delay_ms=4, frame="")
    np.testing.assert_allclose([one.position[0] for one in messages], coder["counts"] * 2 * np.pi / 64, rtol=1e-12)
    assert list(messages[0].name) == ["left_wheel_joint"]
    assert (len(messages[0].velocity), len(messages[0].effort)) == (0, 0)


def test_each_sensor_with_a_place_has_a_frame(bag):
    ((_, static),) = bag[0]["/tf_static"]
    frames = {one.child_frame_id: one for one in static.transforms}
    further = {name for name in frames if name.startswith("sensors/")}
    placed = {"imu", "lidar", "beside", "sonar", "corners", "bumper", "left", "right", "rear"}
    optical = {f"sensors/{name}/optical_frame" for name in ("left", "right", "rear")}
    assert further == {f"sensors/{name}" for name in placed} | optical
    place = frames["sensors/imu"].transform
    assert (place.translation.x, place.translation.y, place.translation.z) == (-0.03, 0.02, 0.06)
    half = np.sqrt(0.5)  # a quarter turn to the left
    turn = place.rotation
    np.testing.assert_allclose([turn.x, turn.y, turn.z, turn.w], [0, 0, half, half], atol=1e-12)
    beside = frames["sensors/beside"].transform.rotation
    # Upwards by 10 degrees about its own y axis after the turn to the right.
    yaw, pitch = np.radians([-45, -5])
    product = [-np.sin(yaw) * np.sin(pitch), np.cos(yaw) * np.sin(pitch)]
    product += [np.sin(yaw) * np.cos(pitch), np.cos(yaw) * np.cos(pitch)]
    np.testing.assert_allclose([beside.x, beside.y, beside.z, beside.w], product, atol=1e-12)
    assert {frames[name].header.frame_id for name in further - optical} == {"base_link"}
    assert frames["sensors/rear/optical_frame"].header.frame_id == "sensors/rear"
    rear = frames["sensors/rear"].transform
    assert (rear.translation.x, rear.translation.z) == (pytest.approx(-0.08), pytest.approx(0.12))
    assert abs(rear.rotation.z) == pytest.approx(1)


def test_images_of_further_cameras(bag, sensing_release):
    for name, period_ms, delay_ms, count in (("left", 200, 0, 4), ("right", 200, 0, 4), ("rear", 300, 50, 3)):
        folder = sensing_release / RUN / f"cameras/{name}"
        frame = f"sensors/{name}/optical_frame"
        t_ms = period_ms * np.arange(count)
        images = stamped(bag, f"{name}/image_raw/compressed", t_ms, delay_ms=delay_ms, frame=frame)
        files = [path.read_bytes() for path in sorted((folder / "images").iterdir())]
        assert [bytes(one.data) for one in images] == files
        model = json.loads((folder / "side/intrinsics.json").read_text())
        for info in stamped(bag, f"{name}/camera_info", t_ms, delay_ms=delay_ms, frame=frame):
            D, K, P = (np.array(getattr(info, one, getattr(info, one.lower(), None))) for one in "DKP")
            assert (info.width, info.height) == (32, 24)
            assert info.distortion_model == ("equidistant" if name == "rear" else "plumb_bob")
            assert D.tolist() == model["D"]
            np.testing.assert_array_equal(K.reshape(3, 3), model["K"])
            # As sensor_msgs/CameraInfo defines P of the second camera of a pair with a baseline of 60 mm.
            shift = -0.06 * model["K"][0][0] if name == "right" else 0.0
            np.testing.assert_allclose(P.reshape(3, 4)[:, 3], [shift, 0, 0], atol=1e-4)
