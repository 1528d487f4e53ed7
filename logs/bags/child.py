"""The child process that reads a bag: `python -m logs.bags.child BAG OUT`.

A bag may come from a stranger, and its chunks may unpack to any size. So this process limits its own memory and time
before it opens the bag. It writes the numbers of all topics that `_PARTS` knows to OUT, an npz archive. Then it prints
their index as one line of JSON, or why the bag cannot be read. Lines before it report the progress.
"""

import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from logs.bags.images import COMPRESSED, RAW, UnknownImageError, image_file
from logs.bags.streams import (
    IMU,
    INDEX,
    INTENSITY,
    LENS,
    MAX_STREAMS,
    POSE,
    PROGRESS,
    RANGE,
    SCAN,
    ImageStream,
    Index,
    Stream,
    ray_columns,
)
from symolo.core.arrays import Array
from symolo.core.extras import optional_module
from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.process_limits import limit_memory, limit_time

_SECONDS, _BYTES_PER_SECOND = 60, 5_000_000
"""Time of the processor for any bag, and the number of bytes for which it gets another second."""
_REPORT_EVERY_S = 0.5
_MEMORY_BYTES = 3_000_000_000
_IMAGE_BYTES = 300_000_000
"""Size of all images of a bag; raw ones count as JPEG files."""
_IMAGES = (RAW, COMPRESSED)
_NS = 1_000_000_000
_MAX_METADATA_BYTES = 200_000
"""Largest size of metadata.yaml, whose reader takes 7 s for a megabyte; a topic has about 600 bytes, and a bag
`MAX_STREAMS`."""
_MAX_DEPTH = 100
"""Largest depth of nested lists in metadata.yaml, which has none in practice."""

Message = Any
"""A message; its class is made at run time from the definitions in the bag."""


@dataclass(frozen=True)
class _Part:
    """The numbers of a message, or of a part of it."""

    stamped: Message
    """The message or part that has the header with the time, if there is one."""
    columns: tuple[str, ...]
    values: Sequence[float] | Array
    parent: str = ""
    child: str = ""


def _pose(stamped: Message, pose: Message, child: str = "") -> _Part:
    p, q = pose.position, pose.orientation
    return _Part(stamped, POSE, [p.x, p.y, p.z, q.x, q.y, q.z, q.w], stamped.header.frame_id, child)


def _transform(stamped: Message) -> _Part:
    p, q = stamped.transform.translation, stamped.transform.rotation
    return _Part(stamped, POSE, [p.x, p.y, p.z, q.x, q.y, q.z, q.w], stamped.header.frame_id, stamped.child_frame_id)


def _odometry(message: Message) -> _Part:
    pose, twist = _pose(message, message.pose.pose, message.child_frame_id), _twist(message, message.twist.twist)
    return replace(pose, columns=(*pose.columns, *twist.columns), values=[*pose.values, *twist.values])


def _twist(stamped: Message, twist: Message) -> _Part:
    return _Part(stamped, ("v_m_s", "w_rad_s"), [twist.linear.x, twist.angular.z])


def _range(message: Message) -> _Part:
    """Return the reading of a range sensor: infinity without a target, minus infinity if it is too close (REP 117)."""
    value = message.range if message.range <= message.max_range else np.inf
    return _Part(message, ("range_m",), [np.nan if value == -np.inf else value], message.header.frame_id)


def _imu(message: Message) -> _Part:
    """Return the readings of an IMU; a covariance that begins with -1 marks those that the device does not measure."""
    values: list[float] = []
    for name in ("linear_acceleration", "angular_velocity"):
        vector, is_absent = getattr(message, name), getattr(message, f"{name}_covariance")[0] == -1
        values += [np.nan] * 3 if is_absent else [vector.x, vector.y, vector.z]
    return _Part(message, IMU, values, message.header.frame_id)


def _scan(message: Message) -> _Part:
    """Return a laser scan; a range is infinite without a return, and NaN where the device failed (REP 117).

    Many devices state 0 where there is no return.
    """
    head = (message.angle_min, message.angle_increment, message.time_increment, message.range_min, message.range_max)
    range_m = np.asarray(message.ranges, dtype=np.float64)
    missed = (range_m == 0.0) | (range_m > message.range_max)
    range_m = np.where(missed, np.inf, np.where(range_m < message.range_min, np.nan, range_m))
    rays, light = len(range_m), np.asarray(message.intensities, dtype=np.float64)
    columns, values = (*SCAN, *ray_columns(RANGE, rays)), [head, range_m]
    if len(light) == rays:
        columns, values = (*columns, *ray_columns(INTENSITY, rays)), [*values, light]
    return _Part(message, columns, np.concatenate(values), message.header.frame_id)


def _joints(message: Message) -> Iterator[_Part]:
    for kind, unit in (("position", "rad"), ("velocity", "rad_s")):
        if len(values := getattr(message, kind)) == len(message.name):
            columns = tuple(f"{name}_{kind}_{unit}" for name in message.name)
            yield _Part(message, columns, list(map(float, values)))


def _lens(message: Message) -> _Part:
    K, D = (getattr(message, name, None) for name in ("K", "D"))  # ROS 2 has small letters
    K, D = (message.k, message.d) if K is None or D is None else (K, D)
    columns = (*LENS, *(f"D_{number}" for number in range(len(D))))
    values = np.concatenate([[message.width, message.height], K, D])
    return _Part(message, columns, values, message.header.frame_id, message.distortion_model)


_PARTS: Mapping[str, Callable[[Message], Iterable[_Part]]] = MappingProxyType(
    {
        "nav_msgs/msg/Odometry": lambda m: [_odometry(m)],
        "geometry_msgs/msg/PoseStamped": lambda m: [_pose(m, m.pose)],
        "geometry_msgs/msg/PoseWithCovarianceStamped": lambda m: [_pose(m, m.pose.pose)],
        "geometry_msgs/msg/TransformStamped": lambda m: [_transform(m)],
        "tf2_msgs/msg/TFMessage": lambda m: map(_transform, m.transforms),
        "tf/msg/tfMessage": lambda m: map(_transform, m.transforms),
        "geometry_msgs/msg/Twist": lambda m: [_twist(m, m)],
        "geometry_msgs/msg/TwistStamped": lambda m: [_twist(m, m.twist)],
        "sensor_msgs/msg/Range": lambda m: [_range(m)],
        "sensor_msgs/msg/Imu": lambda m: [_imu(m)],
        "sensor_msgs/msg/LaserScan": lambda m: [_scan(m)],
        "sensor_msgs/msg/CameraInfo": lambda m: [_lens(m)],
        "sensor_msgs/msg/Temperature": lambda m: [_Part(m, ("temperature_degC",), [m.temperature])],
        "sensor_msgs/msg/JointState": _joints,
        **{
            f"std_msgs/msg/{kind}": lambda m: [_Part(m, ("data",), [float(m.data)])]
            for kind in ("Float32", "Float64", "Int8", "Int16", "Int32", "Int64", "UInt8", "UInt16", "UInt32", "UInt64")
        },
    }
)
"""Function that takes a message apart, by its type."""


@dataclass
class _Rows:
    """The messages of one stream so far."""

    t_ns: list[int] = field(default_factory=list)
    values: list[Sequence[float] | Array] = field(default_factory=list)


@dataclass
class _Files:
    """The images of a topic so far."""

    type: str
    frame: str = ""
    t_ns: list[int] = field(default_factory=list)
    files: list[bytes] = field(default_factory=list)
    problem: str = ""

    def drop(self, problem: str) -> None:
        """Leave the images out, with the reason."""
        self.problem = problem
        self.files.clear()
        self.t_ns.clear()


@dataclass
class _Content:
    """The streams and images of a bag so far."""

    streams: dict[Stream, _Rows] = field(default_factory=dict)
    images: dict[str, _Files] = field(default_factory=dict)
    image_bytes: int = 0
    others: dict[str, str] = field(default_factory=dict)
    """Type of each topic that is left out."""

    def add_image(self, topic: str, kind: str, logged_ns: int, message: Message) -> None:
        """Add an image; the first that cannot be taken ends the topic."""
        images = self.images.setdefault(topic, _Files(kind, message.header.frame_id))
        if images.problem:
            return
        try:
            images.files.append(image_file(message, kind))
            images.t_ns.append(_stamp_ns(message, logged_ns))
        except UnknownImageError as error:
            images.drop(str(error))
            return
        self.image_bytes += len(images.files[-1])
        if self.image_bytes > _IMAGE_BYTES:
            self.image_bytes -= sum(map(len, images.files))
            images.drop(f"the images of the bag have more than {_IMAGE_BYTES / 1e6:g} MB; filter the bag, or cut it")

    def add(self, topic: str, kind: str, logged_ns: int, message: Message) -> None:
        """Add the numbers of a message.

        Raises:
            _TooManyStreamsError: There are too many streams.
        """
        for part in _PARTS[kind](message):
            stream = Stream(topic, kind, part.parent, part.child, part.columns)
            if stream not in self.streams and len(self.streams) == MAX_STREAMS:
                raise _TooManyStreamsError
            rows = self.streams.setdefault(stream, _Rows())
            rows.t_ns.append(_stamp_ns(part.stamped, logged_ns))
            rows.values.append(part.values)


class _TooManyStreamsError(Exception):
    """The bag has more streams than `MAX_STREAMS`."""


def _stamp_ns(stamped: Message, logged_ns: int) -> int:
    """Return the time in the header, or that at which the message was logged where there is none."""
    with suppress(AttributeError):
        stamp = stamped.header.stamp
        return (stamp.sec * _NS + stamp.nanosec) or logged_ns
    return logged_ns


def _check_metadata(metadata: Path) -> None:
    """Raise ValueError for a large file, and for nested lists whose parsing takes the square of their depth in time."""
    if metadata.is_file():
        content = read_file(metadata, FileKind.DOCUMENT)
        if len(content) > _MAX_METADATA_BYTES:
            raise ValueError(f"metadata.yaml has more than {_MAX_METADATA_BYTES:,} bytes")
        brackets = np.frombuffer(content, np.uint8)
        depth = np.cumsum((brackets == ord("[")).astype(np.int64) - (brackets == ord("]")))
        if depth.size and depth.max() > _MAX_DEPTH:
            raise ValueError(f"metadata.yaml is nested deeper than {_MAX_DEPTH} lists")


class _Progress:
    """Prints how many messages were read: at the beginning, now and then, and at the end."""

    def __init__(self, total: int) -> None:
        self._total, self._done = total, 0
        self._print()

    def count(self) -> None:
        """Count a message."""
        self._done += 1
        if time.monotonic() >= self._next_s or self._done == self._total:
            self._print()

    def _print(self) -> None:
        self._next_s = time.monotonic() + _REPORT_EVERY_S
        sys.stdout.write(f"{PROGRESS} {self._done} {self._total}\n")
        sys.stdout.flush()


def _collect(path: Path) -> _Content:
    """Return the numbers and images of each topic, and the type of each topic that is left out."""
    _check_metadata(path / "metadata.yaml")
    typesys, highlevel = optional_module("rosbags.typesys"), optional_module("rosbags.highlevel")
    content = _Content()
    default = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
    with highlevel.AnyReader([path], default_typestore=default) as reader:
        known = [one for one in reader.connections if one.msgtype in _PARTS or one.msgtype in _IMAGES]
        content.others = {one.topic: one.msgtype for one in reader.connections if one not in known}
        progress = _Progress(sum(one.msgcount for one in known))
        for connection, logged_ns, raw in reader.messages(connections=known) if known else ():
            topic, kind = connection.topic, connection.msgtype
            add = content.add_image if kind in _IMAGES else content.add
            add(topic, kind, logged_ns, reader.deserialize(raw, kind))
            progress.count()
    return content


def _write(content: _Content, out: Path) -> Index:
    arrays = {}
    for number, rows in enumerate(content.streams.values()):
        arrays[f"t{number}"] = np.array(rows.t_ns, dtype=np.int64)
        arrays[f"v{number}"] = np.array(rows.values, dtype=np.float64)
    for number, images in enumerate(content.images.values()):
        arrays[f"image_t{number}"] = np.array(images.t_ns, dtype=np.int64)
        arrays[f"image_n{number}"] = np.array([len(file) for file in images.files], dtype=np.int64)
        arrays[f"image_v{number}"] = np.frombuffer(b"".join(images.files), dtype=np.uint8)
    np.savez(out, **arrays)
    known = tuple(ImageStream(topic, one.type, one.frame, one.problem) for topic, one in content.images.items())
    return Index(tuple(content.streams), known, content.others)


def write_topics(path: Path, out: Path) -> Index:
    """Write the numbers of the topics of a bag, and return what they are, or why it cannot be read."""
    try:
        return _write(_collect(path), out)
    except _TooManyStreamsError:
        return Index(error=f"has more than {MAX_STREAMS} topics and transforms")
    except MemoryError:
        return Index(error=f"needs more than {_MEMORY_BYTES / 1e9:g} GB of memory")
    except Exception as error:  # noqa: BLE001 - whatever a library raises on what is no bag
        return Index(error=f"is no bag that can be read: {str(error) or type(error).__name__}")


def main(arguments: Sequence[str]) -> int:
    """Read a bag within limits and write its numbers; return 0, or 1 where it cannot be read."""
    path, out = Path(arguments[0]), Path(arguments[1])
    size = sum(file.stat().st_size for file in ([path] if path.is_file() else path.iterdir()))
    optional_module("rosbags.highlevel")
    limit_memory(_MEMORY_BYTES)
    limit_time(_SECONDS + size // _BYTES_PER_SECOND)
    index = write_topics(path, out)
    sys.stdout.write(INDEX.dump_json(index).decode() + "\n")
    return 1 if index.error else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
