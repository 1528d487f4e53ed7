"""Bags of ROS 1 and ROS 2 that other writers made: a circle in the closed form, and what was measured beside it."""

import math
import struct
import sys

import numpy as np
import pytest
import zstandard
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

from logs.trajectories.base import ReadSettings
from logs.trajectories.readers import READERS
from symolo.core.errors import InputError
from symolo.core.geometry.poses import pose_X_WR
from symolo.core.progress import LineReport
from tests.logs.written_bags import COUNT, POSE, SPEED_M_S, START_NS, T_S, TURN_RAD_S, Ros, bag_of, write_ros1


@pytest.fixture(scope="module", params=[1, 2], ids=["ROS 1", "ROS 2"])
def path(request, tmp_path_factory):
    return bag_of(tmp_path_factory.mktemp("bag"), request.param)


def read(path, **settings):
    reader = next(reader for reader in READERS if reader.recognises(path))
    assert reader.name == "bag"
    return reader.read(path, ReadSettings(**settings))


def test_measured_poses_come_before_odometry_and_the_choice_is_a_guess(path):
    (trajectory,) = read(path)
    np.testing.assert_allclose(trajectory.pose, POSE, atol=1e-9)
    np.testing.assert_allclose(trajectory.t_s - trajectory.t_s[0], T_S, atol=1e-9)
    (guess,) = trajectory.guesses
    assert guess.startswith("poses are those of /mocap/robot; choose others with --topic: /odom,")
    expected = np.where(np.arange(COUNT) // 2 < 5, math.inf, 0.5 + 0.002 * (np.arange(COUNT) // 2))
    np.testing.assert_allclose(trajectory.readings["d_f"], expected, rtol=1e-6)  # floats of 32 bits
    (table,) = trajectory.tables
    unit, commands = table.columns["cmd_vel/v_m_s"]
    assert unit == "m/s"
    np.testing.assert_allclose(commands, 0.2 * (np.arange(COUNT) // 2))
    assert "topics that are not read: /chatter (std_msgs/msg/String)" in trajectory.changes


def test_the_progress_counts_the_messages_that_are_read(path, capsys):
    read(path, report=LineReport())
    with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as bag:
        count = sum(one.msgcount for one in bag.connections if one.topic != "/chatter")
    assert f"read {path.name}: {count} of {count} messages in " in capsys.readouterr().err


def test_topics_and_frames_may_be_named(path):
    odometry, composed = read(path, topics=("/odom", "map:base_footprint"))
    assert (odometry.name, composed.name) == ("/odom", "map:base_footprint")
    assert odometry.guesses == composed.guesses == ()
    np.testing.assert_allclose(composed.pose, POSE, atol=1e-9)
    turned = POSE[:, 2] - 0.4
    np.testing.assert_allclose(odometry.pose[:, 2], turned, atol=1e-9)
    np.testing.assert_allclose(odometry.readings["v"], SPEED_M_S)
    np.testing.assert_allclose(odometry.readings["w"], TURN_RAD_S)
    with pytest.raises(InputError, match=r"--topic: got '/odm', allowed: .*did you mean /odom"):
        read(path, topics=("/odm",))


@pytest.mark.parametrize("odometry", [True, False], ids=["odometry", "transforms alone"])
def test_without_measured_poses_there_is_the_best_estimate(tmp_path, odometry):
    (trajectory,) = read(bag_of(tmp_path, 2, mocap=False, odometry=odometry))
    (guess,) = trajectory.guesses
    taken = "/odom" if odometry else "map:base_footprint"
    assert guess.startswith(f"poses are those of {taken};")
    expected = POSE[:, 2] - (0.4 if odometry else 0.0)
    np.testing.assert_allclose(trajectory.pose[:, 2], expected, atol=1e-9)


def test_a_topic_with_poses_of_two_bodies_has_a_name_for_each(tmp_path):
    ros = Ros(1)
    wand_pose = np.add(POSE, (5.0, 0.0, 0.0))
    stamps = [START_NS + round(1e9 * t_s) for t_s in T_S.tolist()]
    messages = [
        (at_ns, "/vicon", ros.stamped(at_ns, "world", body, pose_X_WR(*pose)))
        for at_ns, *poses in zip(stamps, POSE.tolist(), wand_pose.tolist(), strict=True)
        for body, pose in zip(("robot", "wand"), poses, strict=True)
    ]
    write_ros1(tmp_path / "two.bag", messages, ros)
    wand, robot = read(tmp_path / "two.bag", topics=("/vicon world:wand", "/vicon world:robot"))
    np.testing.assert_allclose(wand.pose, wand_pose, atol=1e-9)
    np.testing.assert_allclose(robot.pose, POSE, atol=1e-9)


def _cut(data):
    return data[: len(data) // 2]


def _garbage(data):
    return data[:13] + np.random.default_rng(1).bytes(2000)


@pytest.mark.parametrize("damage", [_cut, _garbage], ids=["cut", "garbage"])
def test_a_damaged_bag_is_refused_in_one_line(path, damage, tmp_path):
    bad = tmp_path / path.name
    bad.write_bytes(damage(path.read_bytes()))
    with pytest.raises(InputError) as caught:
        read(bad)
    assert str(caught.value).startswith(f"{bad}: ")
    assert "\n" not in str(caught.value)


def test_a_bag_without_poses_says_what_it_needs(tmp_path):
    ros = Ros(1)
    write_ros1(tmp_path / "talk.bag", [(START_NS, "/chatter", ros("std_msgs/String", data="hello"))], ros)
    with pytest.raises(InputError, match=r"talk\.bag: has no topic with the poses of a robot; it needs nav_msgs"):
        read(tmp_path / "talk.bag")


@pytest.mark.long
def test_a_small_bag_that_unpacks_to_more_memory_than_it_may_is_refused(tmp_path):
    """A chunk of MCAP (https://mcap.dev/spec) with 4 GB of zeros, before any message is read."""
    size, block = 4_000_000_000, bytes(50_000_000)
    packer = zstandard.ZstdCompressor(level=1).compressobj(size=size)
    packed = b"".join([*(packer.compress(block) for _ in range(size // len(block))), packer.flush()])

    def text(value):
        return struct.pack("<I", len(value)) + value

    def record(kind, content):
        return bytes([kind]) + struct.pack("<Q", len(content)) + content

    schema = struct.pack("<H", 1) + text(b"std_msgs/msg/Float64") + text(b"ros2msg") + text(b"float64 data")
    channel = struct.pack("<HH", 1, 1) + text(b"/x") + text(b"cdr") + struct.pack("<I", 0)
    chunk = struct.pack("<QQQI", 0, 1, size, 0) + text(b"zstd") + struct.pack("<Q", len(packed)) + packed
    records = [(1, text(b"ros2") + text(b"")), (3, schema), (4, channel), (6, chunk), (15, bytes(4)), (2, bytes(20))]
    magic = b"\x89MCAP0\r\n"
    bomb = tmp_path / "bomb.mcap"
    bomb.write_bytes(magic + b"".join(record(*one) for one in records) + magic)
    assert bomb.stat().st_size < 1_000_000
    with pytest.raises(InputError, match=r"bomb\.mcap: needs more than 3 GB of memory"):
        read(bomb)


def test_a_reader_of_a_bag_that_the_system_ends_is_an_error_in_one_line(tmp_path, monkeypatch):
    killed = tmp_path / "killed"
    killed.write_text("#!/bin/sh\nkill -9 $$\n")
    killed.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(killed))
    (tmp_path / "bomb.mcap").write_bytes(b"\x89MCAP0\r\n")
    with pytest.raises(InputError, match=r"bomb\.mcap: takes too long.*signal 9"):
        read(tmp_path / "bomb.mcap")


@pytest.mark.recordings
def test_bags_that_robots_recorded_hold_what_other_readers_find_in_them(recordings):
    """A TurtleBot under Nav2, by mcap's own reader, and the same transforms as a bag of ROS 1 and of ROS 2."""
    path = recordings / "trajectories/nav2_turtlebot.mcap"
    with path.open("rb") as stream:
        messages = make_reader(stream, decoder_factories=[DecoderFactory()]).iter_decoded_messages(topics=["/odom"])
        odometry = [(message.header.stamp, message.pose.pose.position) for *_, message in messages]
    (trajectory,) = read(path, topics=("/odom",))
    expected = np.array([(stamp.sec + 1e-9 * stamp.nanosec, place.x, place.y) for stamp, place in odometry])
    np.testing.assert_allclose(trajectory.t_s - trajectory.t_s[0], expected[:, 0] - expected[0, 0], atol=1e-6)
    np.testing.assert_allclose(trajectory.pose[:, :2], expected[:, 1:], atol=1e-12)
    (one,), (other,) = (read(recordings / "trajectories" / name) for name in ("tf_example.bag", "tf_example"))
    assert one.quantities["pose"] == other.quantities["pose"] == "odom:base_footprint"
    np.testing.assert_allclose(one.pose, other.pose, atol=1e-12)
