"""The content of a ROS bag of a run: one table of topics for both ROS 1 and ROS 2.

Frames are those of REP 103 and 105: `map` is W, `base_link` is R, `odom` has its origin at the start of the odometry.
`camera_link` has the axes of a body (x forward), and `camera_optical_frame` those of an image (z forward).
"""

import heapq
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from symolo.core.arrays import Array
from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.geometry.poses import mounted, quaternions
from symolo.dataset.tables.side_tables import WHEELS as WHEEL_COLUMNS
from symolo.dataset.tables.side_tables import SideTable
from symolo.exporters.base import image_bytes
from symolo.reader.run import Run
from symolo.reader.run_folder import Image

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

START_NS = 1_000_000_000
"""Stamp of the first row; it is not 0, which means "no time" in ROS and "the latest time" in tf."""
MAP, ODOM, BASE, CAMERA, OPTICAL = "map", "odom", "base_link", "camera_link", "camera_optical_frame"
LINE_SENSOR = "line_sensor"
WHEELS = ("wheel_right", "wheel_left")
WHEEL_TABLE = WHEEL_COLUMNS.name
TOF = {"front": "f", "left": "l", "right": "r"}
"""Names of the ToF sensors, and the last letters of their columns."""
_INFRARED = 1
Stamped = tuple[int, Any]
"""Stamp [ns] and message."""
Planar = tuple[float, float, float]
"""x [m], y [m], yaw [rad]."""


@dataclass(frozen=True)
class Vocabulary:
    """Function that makes the messages of one version of ROS."""

    store: "Typestore"
    version: int

    def __call__(self, name: str, *values: Any) -> Any:  # noqa: ANN401 - of the library, made at run time
        """Return a message of a type such as `geometry_msgs/Point`; values are in the order of the definition."""
        package, kind = name.split("/")
        return self.store.types[f"{package}/msg/{kind}"](*values)

    def header(self, at_ns: int, frame: str, number: int = 0) -> Any:  # noqa: ANN401 - as above
        """Return a header; `number` counts the messages of a topic in ROS 1 and is left out in ROS 2."""
        stamp = self("builtin_interfaces/Time", *divmod(at_ns, 1_000_000_000))
        return self("std_msgs/Header", *([number] if self.version == 1 else []), stamp, frame)

    def vector(self, x: float, y: float, z: float, kind: str = "Vector3") -> Any:  # noqa: ANN401 - as above
        return self(f"geometry_msgs/{kind}", float(x), float(y), float(z))

    def quaternion(self, x: float, y: float, z: float, w: float) -> Any:  # noqa: ANN401 - as above
        return self("geometry_msgs/Quaternion", float(x), float(y), float(z), float(w))

    def upright(self, yaw_rad: float) -> Any:  # noqa: ANN401 - as above
        """Return the rotation about the vertical axis."""
        return self.quaternion(0, 0, np.sin(yaw_rad / 2), np.cos(yaw_rad / 2))

    def twist(self, v_m_s: float, w_rad_s: float) -> Any:  # noqa: ANN401 - as above
        return self("geometry_msgs/Twist", self.vector(v_m_s, 0, 0), self.vector(0, 0, w_rad_s))

    def on_floor(self, at_ns: int, frame: str, child: str, pose: Planar, number: int) -> Any:  # noqa: ANN401 - as above
        """Return a transform between frames whose origin is on the floor."""
        x_m, y_m, yaw_rad = pose
        transform = self("geometry_msgs/Transform", self.vector(x_m, y_m, 0), self.upright(yaw_rad))
        return self("geometry_msgs/TransformStamped", self.header(at_ns, frame, number), child, transform)

    def fixed(self, frame: str, child: str, X: Array) -> Any:  # noqa: ANN401 - as above
        """Return a transform (4, 4) that never changes."""
        X = X + 0.0  # no -0
        rotation = self.quaternion(*quaternions(X[None, :3, :3])[0].tolist())
        transform = self("geometry_msgs/Transform", self.vector(*X[:3, 3].tolist()), rotation)
        return self("geometry_msgs/TransformStamped", self.header(START_NS, frame), child, transform)


@dataclass(frozen=True)
class Log:
    """Tables of a run, read once for all topics."""

    run: Run

    @cached_property
    def at_ns(self) -> list[int]:
        """Stamp [ns] of each row."""
        return [START_NS + t_ms * 1_000_000 for t_ms in self.run.table.t_ms.tolist()]

    @cached_property
    def wheels(self) -> pd.DataFrame:
        return self.run.side("wheels")

    @cached_property
    def odometry(self) -> list[Planar]:
        return self.wheels[["odometry_x", "odometry_y", "odometry_theta"]].to_numpy().tolist()

    def sample_stamps(self, sensor: str) -> list[int]:
        """Return the stamp [ns] of each sample of a sensor of `robot.sensors`."""
        return [START_NS + round(t_ms * 1e6) for t_ms in self.run.sensors[sensor].numbers[:, 0].tolist()]

    def rows(self, *columns: np.ndarray) -> Iterator[tuple[int, int, Any]]:
        """Yield number, stamp [ns] and values of each row."""
        values = zip(*(one.tolist() for one in columns), strict=True)
        return zip(range(len(self.at_ns)), self.at_ns, values, strict=True)


@dataclass(frozen=True)
class Topic:
    name: str
    type: str
    messages: Callable[[Log, Vocabulary], Iterator[Stamped]]
    """Function that yields the messages in the order of time."""
    latched: bool = False
    """Whether a late subscriber gets the last message."""


_ROW_BYTES = 2_700
"""Approximate size in a bag of the messages of a row."""


def estimated_bytes(run: Run) -> int:
    """Return the approximate size of a bag of a run."""
    return image_bytes(run.images) + _ROW_BYTES * len(run)


def messages(run: Run, ros: Vocabulary) -> Iterator[tuple[Topic, int, Any]]:
    """Yield the messages of a run in the order of time; messages of one instant are in the order of `topics`."""
    log, known = Log(run), topics(run)

    def numbered(number: int, topic: Topic) -> Iterator[tuple[int, int, Any]]:
        return ((at_ns, number, message) for at_ns, message in topic.messages(log, ros))

    streams = [numbered(number, topic) for number, topic in enumerate(known)]
    for at_ns, number, message in heapq.merge(*streams, key=lambda one: one[:2]):
        yield known[number], at_ns, message


def _static(log: Log, ros: Vocabulary) -> Iterator[Stamped]:
    robot, poses = log.run.spec.robot, []
    if log.run.numbers:
        camera = log.run.camera
        X_RC, X_CB = np.array(camera.X_RC), np.array(camera.X_CB)
        poses += [(BASE, CAMERA, X_RC @ X_CB), (CAMERA, OPTICAL, np.linalg.inv(X_CB))]
    for name in _ranges_of(log.run):
        mount = getattr(robot.tof.mounts, name)
        place_m, directions_deg = (mount.x_m, mount.y_m, mount.z_m), [mount.yaw_deg, mount.pitch_up_deg]
        poses.append((BASE, _tof_frame(name), mounted(place_m, *np.radians(directions_deg))))
    if "L0" in log.run.table.columns:
        X_RL = np.eye(4)
        X_RL[:3, 3] = robot.line_sensor.x_m, 0.0, robot.line_sensor.height_m
        poses.append((BASE, LINE_SENSOR, X_RL))
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


def _images(log: Log, ros: Vocabulary) -> Iterator[Stamped]:
    for image, at_ns, header in _shutters(log, ros):
        content = np.frombuffer(read_file(image.path, FileKind.IMAGE), dtype=np.uint8)
        yield at_ns, ros("sensor_msgs/CompressedImage", header, "jpeg", content)


def _camera_info(log: Log, ros: Vocabulary) -> Iterator[Stamped]:
    camera = log.run.camera
    K, D = np.array(camera.K), np.array(camera.D)
    P = np.column_stack((K, np.zeros(3)))
    full_image = ros("sensor_msgs/RegionOfInterest", 0, 0, 0, 0, False)  # noqa: FBT003 - a field of the message
    for _image, at_ns, header in _shutters(log, ros):
        size, unbinned = (camera.height_px, camera.width_px), (0, 0)
        matrices = D, K.ravel(), np.eye(3).ravel(), P.ravel()
        fields = *size, camera.distortion_model, *matrices, *unbinned, full_image
        yield at_ns, ros("sensor_msgs/CameraInfo", header, *fields)


def _shutters(log: Log, ros: Vocabulary) -> Iterator[tuple[Image, int, Any]]:
    """Yield image, stamp [ns] and header."""
    for image in log.run.images:
        at_ns = log.at_ns[image.row]
        yield image, at_ns, ros.header(at_ns, OPTICAL, image.index)


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
            yield at_ns, ros("sensor_msgs/Range", header, _INFRARED, *map(float, limits), value, *variance)

    return readings


def _line(log: Log, ros: Vocabulary) -> Iterator[Stamped]:
    channels = log.run.table.line.shape[1]
    layout = ros("std_msgs/MultiArrayLayout", [ros("std_msgs/MultiArrayDimension", "channel", channels, channels)], 0)
    for at_ns, values in zip(log.at_ns, np.ascontiguousarray(log.run.table.line), strict=True):
        yield at_ns, ros("std_msgs/Float64MultiArray", layout, values)


def _sensor(table: SideTable) -> Callable[[Log, Vocabulary], Iterator[Stamped]]:
    """Return the function of the topic of a sensor; the label of its array names the columns and their units."""

    def readings(log: Log, ros: Vocabulary) -> Iterator[Stamped]:
        columns, count = table.columns[1:], len(table.cells) - 1
        label = ", ".join(f"{column.title} [{column.unit}]" for column in columns)
        dimension = ros("std_msgs/MultiArrayDimension", label, count, count)
        layout = ros("std_msgs/MultiArrayLayout", [dimension], 0)
        for at_ns, row in zip(log.sample_stamps(table.name), log.run.sensors[table.name].numbers[:, 1:], strict=True):
            yield at_ns, ros("std_msgs/Float64MultiArray", layout, row.copy())

    return readings


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
CAMERAS = (
    Topic("/camera/camera_info", "sensor_msgs/msg/CameraInfo", _camera_info),
    Topic("/camera/image_raw/compressed", "sensor_msgs/msg/CompressedImage", _images),
)


def topics(run: Run) -> tuple[Topic, ...]:
    """Return the topics of what a run has, and `/sensors/<name>` for each sensor of `robot.sensors`."""
    columns = run.table.columns
    return (
        *POSES,
        *(DRIVE if WHEEL_TABLE in run.side_names else ()),
        *(Topic(f"/tof/{name}", "sensor_msgs/msg/Range", _ranges(name)) for name in _ranges_of(run)),
        *((LINE,) if "L0" in columns else ()),
        *((STATE,) if run.table.has_state else ()),
        *(CAMERAS if run.numbers else ()),
        *(Topic(f"/sensors/{t.name}", "std_msgs/msg/Float64MultiArray", _sensor(t)) for t in run.sensor_tables),
    )


def _ranges_of(run: Run) -> list[str]:
    """Return the names of the range sensors that measured something."""
    return [name for name, letter in TOF.items() if f"d_{letter}" in run.table.columns]
