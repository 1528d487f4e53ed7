"""The reader of bags of ROS 1 and ROS 2, as `readers.py` has it: in this process, without the child's own limits."""

from functools import cache
from itertools import islice
from pathlib import Path
from tempfile import TemporaryDirectory

from rosbags.rosbag2 import StoragePlugin, Writer

from logs.bags.bag import bag_of
from logs.bags.child import write_topics
from logs.trajectories.bag import trajectories_of
from logs.trajectories.base import ReadSettings
from tests.fuzz.guard import Read
from tests.logs import camera_messages, sensor_messages
from tests.logs.written_bags import Ros, drive, write_mcap, write_ros1

FOLDER = "folder"
"""A bag of ROS 2 as a folder of metadata.yaml and a file of SQLite."""


def write_folder(path: Path, messages, ros: Ros) -> None:
    with Writer(path, version=8, storage_plugin=StoragePlugin.SQLITE3) as writer:
        connections = {}
        for at_ns, topic, message in messages:
            kind = message.__msgtype__
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=ros.store)
            writer.write(connections[topic], at_ns, ros.store.serialize_cdr(message, kind))


def _cameras(ros: Ros):
    return camera_messages.messages(ros, camera_messages.images)


@cache
def _valid() -> dict[str, bytes]:
    """Return the content of the files of short bags by path."""
    with TemporaryDirectory() as place:
        root = Path(place)
        for name, version, write, messages in (
            ("a.bag", 1, write_ros1, drive),
            ("a.mcap", 2, write_mcap, drive),
            (FOLDER, 2, write_folder, drive),
            ("sensors.bag", 1, write_ros1, sensor_messages.messages),
            ("sensors.mcap", 2, write_mcap, sensor_messages.messages),
            ("cameras.bag", 1, write_ros1, _cameras),
            ("cameras.mcap", 2, write_mcap, _cameras),
        ):
            ros = Ros(version)
            write(root / name, islice(messages(ros), 30), ros)
        return {path.relative_to(root).as_posix(): path.read_bytes() for path in root.rglob("*") if path.is_file()}


def bags() -> list[bytes]:
    return [f"@{name}\n".encode() + content for name, content in sorted(_valid().items())]


def bag_of_long_metadata() -> bytes:
    """Many keys, which the reader of YAML takes 10 microseconds a byte for."""
    return f"@{FOLDER}/metadata.yaml\n".encode() + b"".join(b"k%d: 1\n" % number for number in range(50_000))


def bag_reader(place: Path) -> Read:
    """Read a bag with one other file, and the poses of its best and of its longest topic."""
    (place / FOLDER).mkdir()
    files = {place / name: content for name, content in _valid().items()}

    def read(data: bytes) -> None:
        line, _, content = data.partition(b"\n")
        path = place / line.removeprefix(b"@").decode(errors="replace")
        if path not in files:
            path, content = place / "a.bag", data
        for other, valid in files.items():
            other.write_bytes(content if other == path else valid)
        bag_path = place / path.relative_to(place).parts[0]
        out = place / "topics.npz"
        bag = bag_of(bag_path, write_topics(bag_path, out), out)
        trajectories_of(bag, ReadSettings())
        poses = [topic for topic in bag.topics if topic.is_pose]
        longest = max(poses, key=lambda topic: len(topic.t_s))
        is_tf = longest.stream.type.endswith("Message")
        trajectories_of(bag, ReadSettings(topics=(longest.frames if is_tf else longest.stream.topic,)))

    return read
