"""The content of a ROS bag of a run: one table of topics for both ROS 1 and ROS 2.

Frames are those of REP 103 and 105: `map` is W, `base_link` is R, `odom` has its origin at the start of the odometry.
`camera_link` has the axes of a body (x forward), and `camera_optical_frame` those of an image (z forward).
"""

import heapq
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from symolo.core.geometry.poses import mounted
from symolo.dataset.layout import SIDE
from symolo.dataset.tables.side_tables import WHEELS as WHEEL_COLUMNS
from symolo.exporters.base import image_bytes
from symolo.exporters.ros.cameras import camera_poses, camera_topics
from symolo.exporters.ros.sensors import sensor_poses, sensor_topics
from symolo.exporters.ros.topic import Log, Stamped, Topic
from symolo.exporters.ros.vocabulary import BASE, INFRARED, MAP, ODOM, START_NS, Planar, Vocabulary
from symolo.reader.run import Run

LINE_SENSOR = "line_sensor"
WHEELS = ("right_wheel_joint", "left_wheel_joint")
"""Joints of the wheels, as in the files of `symolo model`."""
WHEEL_TABLE = WHEEL_COLUMNS.name
TOF = {"front": "f", "left": "l", "right": "r"}
"""Names of the ToF sensors, and the last letters of their columns."""
_ROW_BYTES = 2_700
"""Approximate size in a bag of the messages of a row."""
_TABLE_FACTOR = 5
"""Largest size of the messages of a sensor, relative to its table; IMUs have three matrices in each message."""


def estimated_bytes(run: Run) -> int:
    """Return the approximate size of a bag of a run."""
    images = sum(image_bytes(camera.images) for camera in (run, *run.cameras.values()))
    tables = sum((run.folder / SIDE / table.file).stat().st_size for table in run.sensor_tables)
    return images + _ROW_BYTES * len(run) + _TABLE_FACTOR * tables


def messages(run: Run, ros: Vocabulary) -> Iterator[tuple[Topic, int, Any]]:
    """Yield the messages of a run in the order of time; messages of one instant are in the order of `topics`."""
    log, known = Log(run), topics(run)

    def numbered(number: int, topic: Topic) -> Iterator[tuple[int, int, Any]]:
        return ((at_ns, number, message) for at_ns, message in topic.messages(log, ros))

    streams = [numbered(number, topic) for number, topic in enumerate(known)]
    for at_ns, number, message in heapq.merge(*streams, key=lambda one: one[:2]):
        yield known[number], at_ns, message


def _static(log: Log, ros: Vocabulary) -> Iterator[Stamped]:
    robot, poses = log.run.spec.robot, [*camera_poses(log.run)]
    for name in _ranges_of(log.run):
        mount = getattr(robot.tof.mounts, name)
        place_m, directions_deg = (mount.x_m, mount.y_m, mount.z_m), [mount.yaw_deg, mount.pitch_up_deg]
        poses.append((BASE, _tof_frame(name), mounted(place_m, *np.radians(directions_deg))))
    if "L0" in log.run.table.columns:
        X_RL = np.eye(4)
        X_RL[:3, 3] = robot.line_sensor.x_m, 0.0, robot.line_sensor.height_m
        poses.append((BASE, LINE_SENSOR, X_RL))
    poses += sensor_poses(log.run)
    yield START_NS, ros("tf2_msgs/TFMessage", [ros.fixed(*one) for one in poses])


def _tof_frame(name: str) -> str:
    return f"tof_{name}"


def _moving(log: Log, ros: Vocabulary) -> Iterator[Stamped]:
    """Yield the moving transforms: `map` to `odom` corrects the odometry, so `map` to `base_link` is true (REP 105).

    Without wheels, there is no odometry, and `map` to `base_link` is the only transform.
    """
    has_odometry = WHEEL_TABLE in log.run.side_names
    for number, at_ns, (true_pose,) in log.rows(log.run.table.pose):
        if not has_odometry:
            yield at_ns, ros("tf2_msgs/TFMessage", [ros.on_floor(at_ns, MAP, BASE, true_pose, number)])
            continue
        odometry = log.odometry[number]
        poses = ((MAP, ODOM, _odometry_frame(true_pose, odometry)), (ODOM, BASE, odometry))
        transforms = [ros.on_floor(at_ns, frame, child, pose, number) for frame, child, pose in poses]
        yield at_ns, ros("tf2_msgs/TFMessage", transforms)


def _odometry_frame(X_WR: Planar, X_OR: Planar) -> Planar:
    """Return X_WO, for which X_WO X_OR = X_WR."""
    x_m, y_m, yaw_rad = X_OR
    turn_rad = X_WR[2] - yaw_rad
    c, s = np.cos(turn_rad), np.sin(turn_rad)
    return X_WR[0] - (c * x_m - s * y_m), X_WR[1] - (s * x_m + c * y_m), turn_rad


def _odometry(ros: Vocabulary, header: object, pose: Planar, twist: tuple[float, float]) -> Any:  # noqa: ANN401 - as above
    """Return odometry with covariances of 0: the true pose has no error, and those of the wheels are unknown."""
    pose_message = ros("geometry_msgs/Pose", ros.vector(pose[0], pose[1], 0, "Point"), ros.upright(pose[2]))
    return ros(
        "nav_msgs/Odometry",
        header,
        BASE,
        ros("geometry_msgs/PoseWithCovariance", pose_message, np.zeros(36)),
        ros("geometry_msgs/TwistWithCovariance", ros.twist(*twist), np.zeros(36)),
    )


def _truth(log: Log, ros: Vocabulary) -> Iterator[Stamped]:
    # ROS has no other way to say that a speed is not known.
    twists = np.nan_to_num(log.run.table.twist)
    for number, at_ns, (pose, twist) in log.rows(log.run.table.pose, twists):
        yield at_ns, _odometry(ros, ros.header(at_ns, MAP, number), pose, twist)


def _wheel_odometry(log: Log, ros: Vocabulary) -> Iterator[Stamped]:
    """Yield the odometry, with the twist from the measured speeds of the wheels (paper Eq. 1-5)."""
    drive = log.run.spec.robot.drive
    right_m_s, left_m_s = (0.5 * drive.wheel_diameter_m * log.wheels[f"speed_{wheel}"].to_numpy() for wheel in "rl")
    for number, at_ns, twist in log.rows(0.5 * (right_m_s + left_m_s), (right_m_s - left_m_s) / drive.track_m):
        yield at_ns, _odometry(ros, ros.header(at_ns, ODOM, number), log.odometry[number], twist)


def _ranges(name: str) -> Callable[[Log, Vocabulary], Iterator[Stamped]]:
    """Return the function of the topic of a ToF sensor; +inf (REP 117) stands for the no-target value of data.csv."""

    def readings(log: Log, ros: Vocabulary) -> Iterator[Stamped]:
        tof = log.run.spec.robot.tof
        limits = np.radians(tof.field_of_view_deg), tof.min_range_m, tof.max_range_m
        column = [*TOF].index(name)
        range_m = np.where(log.run.no_target[:, column], np.inf, log.run.table.tof_m[:, column])
        variance = [0.0] if ros.version > 1 else []  # 0: unknown
        for number, at_ns, (value,) in log.rows(range_m):
            header = ros.header(at_ns, _tof_frame(name), number)
            yield at_ns, ros("sensor_msgs/Range", header, INFRARED, *map(float, limits), value, *variance)

    return readings


def _line(log: Log, ros: Vocabulary) -> Iterator[Stamped]:
    channels = log.run.table.line.shape[1]
    layout = ros("std_msgs/MultiArrayLayout", [ros("std_msgs/MultiArrayDimension", "channel", channels, channels)], 0)
    for at_ns, values in zip(log.at_ns, np.ascontiguousarray(log.run.table.line), strict=True):
        yield at_ns, ros("std_msgs/Float64MultiArray", layout, values)


def _joints(log: Log, ros: Vocabulary) -> Iterator[Stamped]:
    """Yield encoder angles and measured speeds; the robot does not measure the torque of its motors."""
    turn_rad = 2 * np.pi / log.run.spec.robot.encoder.counts_per_revolution
    counts, speeds = (
        np.ascontiguousarray(log.wheels[[f"{name}_r", f"{name}_l"]].to_numpy(dtype=np.float64))
        for name in ("counts", "speed")
    )
    for number, at_ns in enumerate(log.at_ns):
        values = turn_rad * counts[number], speeds[number], np.zeros(0)
        yield at_ns, ros("sensor_msgs/JointState", ros.header(at_ns, "", number), [*WHEELS], *values)


def _commands(log: Log, ros: Vocabulary) -> Iterator[Stamped]:
    for number, at_ns, twist in log.rows(*(log.wheels[f"command_{one}"].to_numpy() for one in "vw")):
        yield at_ns, ros("geometry_msgs/TwistStamped", ros.header(at_ns, BASE, number), ros.twist(*twist))


def _states(log: Log, ros: Vocabulary) -> Iterator[Stamped]:
    for _number, at_ns, (state,) in log.rows(log.run.table.state):
        yield at_ns, ros("std_msgs/Int32", int(state))


POSES = (
    Topic("/tf_static", "tf2_msgs/msg/TFMessage", _static, latched=True),
    Topic("/tf", "tf2_msgs/msg/TFMessage", _moving),
    Topic("/ground_truth/odom", "nav_msgs/msg/Odometry", _truth),
)
DRIVE = (
    Topic("/odom", "nav_msgs/msg/Odometry", _wheel_odometry),
    Topic("/joint_states", "sensor_msgs/msg/JointState", _joints),
    Topic("/cmd_vel", "geometry_msgs/msg/TwistStamped", _commands),
)
LINE = Topic("/line_sensor", "std_msgs/msg/Float64MultiArray", _line)
STATE = Topic("/state", "std_msgs/msg/Int32", _states)


def topics(run: Run) -> tuple[Topic, ...]:
    """Return the topics of what a run has."""
    columns = run.table.columns
    return (
        *POSES,
        *(DRIVE if WHEEL_TABLE in run.side_names else ()),
        *(Topic(f"/tof/{name}", "sensor_msgs/msg/Range", _ranges(name)) for name in _ranges_of(run)),
        *((LINE,) if "L0" in columns else ()),
        *((STATE,) if run.table.has_state else ()),
        *camera_topics(run),
        *sensor_topics(run),
    )


def _ranges_of(run: Run) -> list[str]:
    """Return the names of the range sensors that measured something."""
    return [name for name, letter in TOF.items() if f"d_{letter}" in run.table.columns]
