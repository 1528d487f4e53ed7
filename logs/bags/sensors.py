"""Laser scanners and IMUs of a bag as sensors of the robot, with samples at their own times.

The messages are sensor_msgs/LaserScan and sensor_msgs/Imu (https://docs.ros.org/en/rolling/p/sensor_msgs/).
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from logs.bags.bag import Bag, Topic
from logs.bags.frames import Track, between
from logs.bags.streams import IMU, INTENSITY, RANGE, SCAN
from logs.decimals import decimals_of
from logs.times import usual_step
from logs.trajectories.base import LoggedSensor
from symolo.core.arrays import Array
from symolo.core.geometry.poses import roll_pitch_yaw
from symolo.core.progress import plural
from symolo.dataset.tables.column import Column
from symolo.dataset.tables.sensor_tables import LOGGED, MAX_COLUMNS, TAKEN_NAMES

_MAX_NAME = 40
_STILL = 0.005
"""Largest change of a place [m] or of a direction [rad] of a sensor that is fixed to the robot."""
_OWN_TABLES = ("drive", "log", LOGGED)
"""Names of tables of an imported run that are not those of a topic."""


@dataclass(frozen=True)
class BagSensors:
    """The sensors of a bag."""

    sensors: tuple[LoggedSensor, ...]
    topics: dict[str, str]
    """Topic and number of the messages by the name of the sensor."""
    notes: tuple[str, ...]
    """Omissions and unknown settings, in one sentence each."""


def sensors_of(bag: Bag, robot_frame: str, transforms: Sequence[Track]) -> BagSensors:
    """Return the laser scanners and IMUs of a bag.

    Args:
        bag: The bag.
        robot_frame: Frame of the robot whose poses are read; empty if it is not known.
        transforms: Transforms of tf, from which the places of the sensors on the robot follow.
    """
    sensors, topics, notes = [], {}, []
    for topic in _largest_topics(bag.topics, notes):
        name = sensor_name(topic.stream.topic, tuple(topics))
        if len(topic.t_s) < 2:
            notes.append(f"left out: {topic.stream.topic} has fewer than two messages")
            continue
        X_RS = pose_on_robot(topic.stream.parent, robot_frame, transforms)
        mount = {} if isinstance(X_RS, str) else mount_settings(X_RS)
        if isinstance(X_RS, str):
            notes.append(f"{name}: {X_RS}, so its place on the robot is not known")
        sensor = _imu(topic, name, mount) if is_imu(topic) else _lidar(topic, name, mount)
        if isinstance(sensor, str):
            notes.append(f"left out: {topic.stream.topic}: {sensor}")
            continue
        what = "scan" if is_scan(topic) else "sample"
        topics[name] = f"{topic.stream.topic}: {plural(len(topic.t_s), what)}"
        sensors.append(sensor)
    return BagSensors(tuple(sensors), topics, tuple(notes))


def is_imu(topic: Topic) -> bool:
    return topic.stream.columns == IMU


def is_scan(topic: Topic) -> bool:
    return topic.stream.columns[: len(SCAN)] == SCAN


def _largest_topics(topics: Sequence[Topic], notes: list[str]) -> Iterator[Topic]:
    """Yield a stream for each topic of a sensor: that with the most messages, as scans may differ in their rays."""
    streams = [topic for topic in topics if is_imu(topic) or is_scan(topic)]
    for name in dict.fromkeys(topic.stream.topic for topic in streams):
        first, *others = sorted((t for t in streams if t.stream.topic == name), key=lambda t: -len(t.t_s))
        if others:
            count = sum(len(topic.t_s) for topic in others)
            notes.append(f"left out: {plural(count, 'message')} of {name} with another number of rays or another frame")
        yield first


def sensor_name(topic: str, taken: Sequence[str]) -> str:
    """Return a name for a sensor, which is also that of its file: that of the topic in small letters.

    Args:
        topic: Name of the topic, or of a name space.
        taken: Names of other sensors.
    """
    plain = re.sub(r"[^a-z0-9]+", "_", topic.lower().removeprefix("/sensors/")).strip("_")[:_MAX_NAME]
    if not re.match("[a-z]", plain) or plain in TAKEN_NAMES or plain in _OWN_TABLES:
        plain = f"bag_{plain}".strip("_")
    name, number = plain, 2
    while name in taken:
        name, number = f"{plain}_{number}", number + 1
    return name


def pose_on_robot(frame: str, robot_frame: str, transforms: Sequence[Track]) -> Array | str:
    """Return the pose (4, 4) of a frame on the robot, or why it is not known."""
    if frame and frame.lstrip("/") == robot_frame.lstrip("/"):
        return np.eye(4)
    track = between(robot_frame, frame, transforms) if frame and robot_frame else None
    if track is None or not len(track.t_s):
        return f"no transform leads from {robot_frame or 'the robot'} to {frame or 'its frame, which has no name'}"
    X = track.matrices
    if np.ptp(X, axis=0).max() > _STILL:
        return f"{frame} moves on the robot"
    return X[0]


def mount_settings(X_RS: Array) -> dict[str, float]:
    """Return the place of a sensor on the robot as its settings, from the pose of its frame, x forward and z up."""
    x_m, y_m, z_m = X_RS[:3, 3].tolist()
    roll_deg, pitch_deg, yaw_deg = np.degrees(roll_pitch_yaw(X_RS[:3, :3])).tolist()
    values = {"x_m": x_m, "y_m": y_m, "z_m": z_m}
    values |= {"yaw_deg": yaw_deg, "pitch_up_deg": -pitch_deg, "roll_deg": roll_deg}
    return {name: round(value, 6) + 0.0 for name, value in values.items()}


def _imu(topic: Topic, name: str, mount: dict[str, float]) -> LoggedSensor:
    columns = [
        Column(column, unit, decimals_of(topic.column(column)), text)
        for prefix, unit, text in (
            ("acc", "m/s2", "specific force along the axis of the sensor"),
            ("gyro", "rad/s", "angular rate about the axis of the sensor"),
        )
        for column in IMU
        if column.startswith(prefix)
    ]
    settings = {"period_s": _period_s(topic), "delay_s": 0.0, **mount}
    meaning = f"accelerometer and gyroscope: messages of {topic.stream.topic}"
    return LoggedSensor(name, "imu", meaning, topic.t_s, tuple(columns), topic.values, settings)


def _lidar(topic: Topic, name: str, mount: dict[str, float]) -> LoggedSensor | str:
    """Return a lidar, whose scans have the time of their last ray; or why its scans cannot be taken."""
    rays = sum(column.startswith(f"{RANGE}_") for column in topic.stream.columns)
    if not 0 < rays <= MAX_COLUMNS:
        return f"its scans have {plural(rays, 'ray')}, and 1 to {MAX_COLUMNS} are possible"
    heads = topic.values[:, : len(SCAN)]
    if not np.isfinite(heads).all():
        return "the angles or limits of its scans are no numbers"
    first_rad, step_rad, ray_s, min_m, max_m = np.median(heads, axis=0).tolist()
    if np.any(np.ptp(heads[:, :2], axis=0) * (1, rays) > abs(step_rad)):
        return "its scans begin at different angles, and a column of a table has one angle"
    range_m = topic.values[:, len(SCAN) : len(SCAN) + rays]
    light = topic.values[:, len(SCAN) + rays :]
    # A table has 0 for no return.
    range_m = np.where(np.isinf(range_m), 0.0, range_m)
    columns = [Column(RANGE, "m", decimals_of(range_m, np.float32), "distance along the ray, 0 for no return", rays)]
    if light.size:
        columns.append(
            Column(INTENSITY, "-", decimals_of(light, np.float32), "intensity in the unit of the device", rays)
        )
    settings = {
        "period_s": _period_s(topic),
        "delay_s": 0.0,
        "sweep_s": round(max(ray_s, 0.0) * rays, 6),
        "rays": rays,
        "first_ray_deg": round(float(np.degrees(first_rad)), 4) + 0.0,
        "ray_step_deg": round(float(np.degrees(step_rad)), 6),
        "min_range_m": round(min_m, 6),
        "max_range_m": round(max_m, 6),
        **mount,
    }
    # The stamp of a message is the time of its first ray.
    t_s = topic.t_s + max(ray_s, 0.0) * (rays - 1)
    meaning = f"laser scans: messages of {topic.stream.topic}; t is the time of the last ray"
    values = np.column_stack((range_m, light)) if light.size else range_m
    return LoggedSensor(name, "lidar", meaning, t_s, tuple(columns), values, settings)


def _period_s(topic: Topic) -> float:
    return round(usual_step(np.diff(topic.t_s)), 6)
