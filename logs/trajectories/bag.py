"""Bags of ROS 1 and ROS 2: the pose of a robot from a topic or from transforms, and what other topics measured.

The messages are those of nav_msgs, geometry_msgs, tf2_msgs, sensor_msgs and std_msgs (https://docs.ros.org/en/rolling/p/).
"""

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from logs.bags.bag import Bag, Topic, read_bag
from logs.bags.cameras import cameras_of, is_lens
from logs.bags.frames import Track, between, pairs, robot_frames
from logs.bags.sensors import is_imu, is_scan, sensors_of
from logs.recognition import first_bytes, is_file, is_folder
from logs.times import usual_step
from logs.trajectories.base import LoggedTable, LoggedTrajectory, ReadSettings, TrajectoryReader
from logs.trajectories.planar import on_floor
from logs.trajectories.table import LOG_TABLE
from symolo.core.arrays import Array
from symolo.core.errors import InputError, nearest
from symolo.core.geometry.poses import rotations
from symolo.core.progress import plural

_MAGIC = (b"#ROSBAG V2.0", b"\x89MCAP0\r\n", b"SQLite format 3\x00")
_ENDINGS = (".bag", ".mcap", ".db3")
_TRUTH = re.compile(r"ground_?truth|\bgt\b|mocap|motion_capture|vicon|optitrack|qualisys|phasespace")
_NO_POSE_OF_THE_ROBOT = re.compile(r"goal|initialpose|target|setpoint|plan|cmd")
_SIDES = {"front": "d_f", "left": "d_l", "right": "d_r"}
_HELD_STEPS = 1.5
"""Largest age of a reading beside a pose, in usual steps of its topic."""
_MIN_LENGTH = 0.5
"""Smallest length of a quaternion; that of an unset one is 0."""


def _read(path: Path, settings: ReadSettings) -> list[LoggedTrajectory]:
    return trajectories_of(read_bag(path, settings.report), settings)


def trajectories_of(bag: Bag, settings: ReadSettings) -> list[LoggedTrajectory]:
    """Return the poses of the robot in a bag, or those of each topic in the settings.

    Raises:
        InputError: There are no such poses.
    """
    tracks = {track.name: track for track in _tracks(bag)}
    transforms = [_track(topic) for topic in bag.topics if _is_tf(topic)]
    if settings.topics:
        chosen = [_chosen(name, tracks, transforms, bag.path) for name in settings.topics]
        return [_trajectory(bag, track, transforms, settings) for track in chosen]
    track, others = _best(tracks, transforms, bag.path)
    guesses = ()
    if others:
        more = f" and {len(others) - 5} more" if len(others) > 5 else ""
        guesses = (f"poses are those of {track.name}; choose others with --topic: {', '.join(others[:5])}{more}",)
    return [_trajectory(bag, track, transforms, settings, guesses)]


def _is_tf(topic: Topic) -> bool:
    return topic.stream.type.endswith(("/TFMessage", "/tfMessage"))


def _tracks(bag: Bag) -> list[Track]:
    """Return the poses of all topics but those of tf; a topic with poses of several frames has one name for each."""
    topics = [topic for topic in bag.topics if topic.is_pose and not _is_tf(topic)]
    counts = Counter(topic.stream.topic for topic in topics)
    tracks = [_track(topic) for topic in topics]
    names = [f"{t.stream.topic} {t.frames}" if counts[t.stream.topic] > 1 else t.stream.topic for t in topics]
    return [replace(track, name=name) for track, name in zip(tracks, names, strict=True)]


def _track(topic: Topic) -> Track:
    good = np.linalg.norm(topic.values[:, 3:7], axis=1) > _MIN_LENGTH
    good &= np.isfinite(topic.values[:, :7]).all(axis=1)
    return Track.from_topic(topic, good)


def _chosen(name: str, tracks: dict[str, Track], transforms: Sequence[Track], path: Path) -> Track:
    """Return the poses of a topic, or those between two frames.

    Raises:
        InputError: There are none.
    """
    if name in tracks:
        return tracks[name]
    parent, colon, child = name.partition(":")
    if colon and (track := between(parent, child, transforms)) is not None:
        return track
    names = [*tracks, *pairs(transforms)]
    hint = nearest(name, names)
    raise InputError("--topic", where=str(path), got=name, allowed=", ".join(names) or "no poses", nearest=hint)


def _best(tracks: dict[str, Track], transforms: Sequence[Track], path: Path) -> tuple[Track, list[str]]:
    """Return the poses that are most likely those of the robot, and the names of others.

    Measured ones come before estimates, and all topics of poses before transforms.

    Raises:
        InputError: No topic has poses.
    """

    def rank(name: str) -> tuple[int, int]:
        kind = 0 if _TRUTH.search(name.lower()) else 1 + tracks[name].is_odometry
        return kind, -len(tracks[name].t_s)

    usable = [name for name, track in tracks.items() if len(track.t_s) > 1]
    robots = [name for name in usable if not _NO_POSE_OF_THE_ROBOT.search(name.lower())] or usable
    frames = robot_frames(transforms)
    robot_track = frames and between(*frames, transforms)
    tracks_by_rank = [*(tracks[name] for name in sorted(robots, key=rank)), *([robot_track] if robot_track else [])]
    if tracks_by_rank:
        names = dict.fromkeys([*(track.name for track in tracks_by_rank[1:]), *pairs(transforms)])
        return tracks_by_rank[0], [name for name in names if name != tracks_by_rank[0].name]
    cure = "it needs nav_msgs/Odometry, a pose or a transform of geometry_msgs, or tf; see docs/import.md"
    raise InputError("has no topic with the poses of a robot", where=str(path), cure=cure)


def _trajectory(
    bag: Bag, track: Track, transforms: Sequence[Track], settings: ReadSettings, guesses: tuple[str, ...] = ()
) -> LoggedTrajectory:
    where = f"{bag.path} ({track.name})"
    new = np.concatenate(([True], np.diff(track.t_s) > 0.0)) if len(track.t_s) else np.zeros(0, bool)
    if np.count_nonzero(new) < 2:
        raise InputError("has fewer than two poses", where=where)
    t_s, values = track.t_s[new], track.values[new]
    changes = [*track.changes]
    if not new.all():
        changes.append(f"left out: {plural(np.count_nonzero(~new), 'pose')} with the time of another one")
    floor = on_floor(values[:, :3], rotations(values[:, 3:7]), where, up=settings.up, forward=settings.forward)
    quantities = {"t": "stamps of the messages, in ns", **floor.quantities, "pose": track.name}
    readings: dict[str, Array] = {}
    if track.is_odometry:
        readings |= {"v": values[:, 7].copy(), "w": values[:, 8].copy()}
        quantities["v, w"] = f"twist of {track.name}"
    ranges = _ranges(bag)
    for column, topic in ranges.items():
        readings[column] = _held(topic, t_s)[:, 0]
        quantities[column] = topic.stream.topic
    used = {id(topic) for topic in ranges.values()}
    is_sensor = [topic for topic in bag.topics if is_imu(topic) or is_scan(topic) or is_lens(topic)]
    used |= {id(topic) for topic in is_sensor}
    others = [topic for topic in bag.topics if not topic.is_pose and id(topic) not in used]
    robot_frame = _robot_frame(track, transforms) if floor.is_rep_103 else ""
    sensors = sensors_of(bag, robot_frame, transforms)
    cameras = cameras_of(bag, robot_frame, transforms, tuple(sensors.topics))
    quantities |= {**sensors.topics, **cameras.topics}
    changes += (*sensors.notes, *cameras.notes)
    if robot_frame and not track.child and (sensors.sensors or cameras.cameras):
        changes.append(f"places of sensors are those in {robot_frame}, for whose poses those of {track.name} are taken")
    if bag.left_out:
        changes.append("topics that are not read: " + ", ".join(f"{t} ({kind})" for t, kind in bag.left_out.items()))
    return LoggedTrajectory(
        t_s,
        floor.pose,
        quantities,
        readings,
        _table(bag, others, t_s),
        (*changes, *floor.changes),
        (*guesses, *floor.guesses),
        floor.warnings,
        name=track.name if len(settings.topics) > 1 else "",
        sensors=sensors.sensors,
        cameras=cameras.cameras,
    )


def _robot_frame(track: Track, transforms: Sequence[Track]) -> str:
    """Return the frame of the poses on the robot, or its usual name where the messages do not name it."""
    if track.child:
        return track.child
    frames = robot_frames(transforms)
    return frames[1] if frames else ""


def _ranges(bag: Bag) -> dict[str, Topic]:
    """Return the range sensors by column of data.csv, where exactly one is named after a side."""
    topics = [topic for topic in bag.topics if topic.stream.columns == ("range_m",)]
    topic_by_column = {}
    for side, column in _SIDES.items():
        named = [topic for topic in topics if side in f"{topic.stream.topic} {topic.stream.parent}".lower()]
        if len(named) == 1:
            topic_by_column[column] = named[0]
    return topic_by_column


def _held(topic: Topic, t_s: Array) -> Array:
    """Return the last values (N, columns) of a topic at some times; NaN where there are none or they are too old."""
    at = np.searchsorted(topic.t_s, t_s, side="right") - 1
    limit_s = _HELD_STEPS * usual_step(np.diff(topic.t_s)) if len(topic.t_s) > 1 else np.inf
    fresh = (at >= 0) & (t_s - topic.t_s[np.maximum(at, 0)] <= limit_s)
    return np.where(fresh[:, None], topic.values[np.maximum(at, 0)], np.nan)


def _table(bag: Bag, topics: Sequence[Topic], t_s: Array) -> tuple[LoggedTable, ...]:
    columns: dict[str, tuple[str, Array]] = {}
    for topic in topics:
        values = _held(topic, t_s)
        for name, column in zip(topic.stream.columns, values.T, strict=True):
            finite = np.where(np.isfinite(column), column, np.nan)
            if np.isfinite(finite).any():
                columns[f"{topic.stream.topic.strip('/')}/{name}"] = _unit(name), finite
    meaning = f"topics of {bag.path.name}, each with its last message before the pose"
    return (LoggedTable(LOG_TABLE, meaning, columns),) if columns else ()


_UNITS = {"_rad_s": "rad/s", "_m_s2": "m/s2", "_m_s": "m/s", "_rad": "rad", "_m": "m", "_degC": "degC"}


def _unit(name: str) -> str:
    return next((unit for end, unit in _UNITS.items() if name.endswith(end)), "-")


def _recognises(path: Path) -> bool:
    if is_folder(path):
        return is_file(path / "metadata.yaml") and any(path.glob(f"*{end}") for end in _ENDINGS)
    return path.suffix.lower() in _ENDINGS and first_bytes(path, 16).startswith(_MAGIC)


READER = TrajectoryReader("bag", "a bag of ROS 1, or a bag of ROS 2 in MCAP or SQLite", _recognises, _read)
