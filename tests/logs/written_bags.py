"""Bags of a drive in a circle, in messages of ROS 1 and ROS 2, by writers that are not ours."""

import math

import numpy as np
from mcap_ros2.writer import Writer as McapWriter
from rosbags.rosbag1 import Writer as Writer1
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from symolo.core.geometry.poses import pose_X_WR, quaternions

COUNT, STEP_S, RADIUS_M, START_NS = 60, 0.05, 0.6, 1_700_000_000_123_456_789
T_S = STEP_S * np.arange(COUNT)
ANGLE = 0.5 * T_S
POSE = np.column_stack((RADIUS_M * np.cos(ANGLE), RADIUS_M * np.sin(ANGLE), ANGLE + 0.5 * math.pi))
X_MO = pose_X_WR(0.3, -0.2, 0.4)
"""Of the frame odom in the frame map, as a localisation would correct it."""
SPEED_M_S, TURN_RAD_S = 0.3, 0.5


class Ros:
    """Messages of one version, and a bag to write them to."""

    def __init__(self, version):
        self.version = version
        self.store = get_typestore(Stores.ROS1_NOETIC if version == 1 else Stores.ROS2_HUMBLE)
        self.store.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", "tf2_msgs/msg/TFMessage"))

    def __call__(self, name, **fields):
        package, kind = name.split("/")
        return self.store.types[f"{package}/msg/{kind}"](**fields)

    def header(self, at_ns, frame):
        stamp = self("builtin_interfaces/Time", sec=at_ns // 10**9, nanosec=at_ns % 10**9)
        return self("std_msgs/Header", stamp=stamp, frame_id=frame, **({"seq": 0} if self.version == 1 else {}))

    def pose(self, X):
        p, q = X[:3, 3].tolist(), quaternions(X[None, :3, :3])[0].tolist()
        position = self("geometry_msgs/Point", **dict(zip("xyz", p, strict=True)))
        return self(
            "geometry_msgs/Pose",
            position=position,
            orientation=self("geometry_msgs/Quaternion", **dict(zip("xyzw", q, strict=True))),
        )

    def transform(self, at_ns, parent, child, X):
        return self("tf2_msgs/TFMessage", transforms=[self.stamped(at_ns, parent, child, X)])

    def stamped(self, at_ns, parent, child, X):
        p, q = X[:3, 3].tolist(), quaternions(X[None, :3, :3])[0].tolist()
        translation = self("geometry_msgs/Vector3", **dict(zip("xyz", p, strict=True)))
        rotation = self("geometry_msgs/Quaternion", **dict(zip("xyzw", q, strict=True)))
        transform = self("geometry_msgs/Transform", translation=translation, rotation=rotation)
        return self(
            "geometry_msgs/TransformStamped",
            header=self.header(at_ns, parent),
            child_frame_id=child,
            transform=transform,
        )

    def twist(self, v, w):
        zero = {"x": 0.0, "y": 0.0, "z": 0.0}
        linear, angular = ({**zero, "x": v}, {**zero, "z": w})
        return self(
            "geometry_msgs/Twist",
            linear=self("geometry_msgs/Vector3", **linear),
            angular=self("geometry_msgs/Vector3", **angular),
        )

    def odometry(self, at_ns, X):
        cov = np.zeros(36)
        return self(
            "nav_msgs/Odometry",
            header=self.header(at_ns, "odom"),
            child_frame_id="base_footprint",
            pose=self("geometry_msgs/PoseWithCovariance", pose=self.pose(X), covariance=cov),
            twist=self("geometry_msgs/TwistWithCovariance", twist=self.twist(SPEED_M_S, TURN_RAD_S), covariance=cov),
        )

    def range(self, at_ns, value):
        fields = {"radiation_type": 1, "field_of_view": 0.4, "min_range": 0.0, "max_range": 1.2, "range": value}
        return self("sensor_msgs/Range", header=self.header(at_ns, "tof_front"), **fields)


def drive(ros, *, mocap=True, odometry=True):
    """Time [ns] in the bag, topic and message; poses are logged 7 ms after they were taken."""
    yield START_NS, "/tf", ros.transform(START_NS, "map", "odom", X_MO)
    yield START_NS, "/chatter", ros("std_msgs/String", data="hello")
    for i, (t_s, pose) in enumerate(zip(T_S.tolist(), POSE.tolist(), strict=True)):
        at_ns = START_NS + round(1e9 * t_s)
        X_WR, late_ns = pose_X_WR(*pose), at_ns + 7_000_000
        X_OR = np.linalg.inv(X_MO) @ X_WR
        if mocap:
            stamped = ros("geometry_msgs/PoseStamped", header=ros.header(at_ns, "world"), pose=ros.pose(X_WR))
            yield late_ns, "/mocap/robot", stamped
        if odometry:
            yield late_ns, "/odom", ros.odometry(at_ns, X_OR)
        yield late_ns, "/tf", ros.transform(at_ns, "odom", "base_footprint", X_OR)
        if i % 2 == 0:
            yield at_ns, "/tof/front", ros.range(at_ns, math.inf if i < 10 else 0.5 + 0.001 * i)
            yield at_ns, "/cmd_vel", ros.twist(0.1 * i, -0.2)


def write_ros1(path, messages, ros):
    with Writer1(path) as writer:
        connections = {}
        for at_ns, topic, message in messages:
            kind = message.__msgtype__
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=ros.store)
            writer.write(connections[topic], at_ns, ros.store.serialize_ros1(message, kind))


def plain(message):
    """A message as mcap's own writer takes it."""
    if hasattr(message, "__msgtype__"):
        names = [name for name in message.__dataclass_fields__ if name != "__msgtype__"]
        return {name: plain(getattr(message, name)) for name in names}
    return [plain(one) for one in message] if isinstance(message, list | np.ndarray) else message


def write_mcap(path, messages, ros):
    with path.open("wb") as stream, McapWriter(stream) as writer:
        schemas = {}
        for at_ns, topic, message in messages:
            kind = message.__msgtype__
            if kind not in schemas:
                text = ros.store.generate_msgdef(kind, ros_version=2)[0]
                schemas[kind] = writer.register_msgdef(kind, text)
            writer.write_message(topic, schemas[kind], plain(message), at_ns, at_ns)


def bag_of(folder, version, **parts):
    ros, path = Ros(version), folder / ("drive.bag" if version == 1 else "drive.mcap")
    (write_ros1 if version == 1 else write_mcap)(path, drive(ros, **parts), ros)
    return path
