"""Makes the messages of one version of ROS."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from symolo.core.arrays import Array
from symolo.core.geometry.poses import quaternions

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

START_NS = 1_000_000_000
"""Stamp of the first row; it is not 0, which means "no time" in ROS and "the latest time" in tf."""
MAP, ODOM, BASE = "map", "odom", "base_link"
ULTRASOUND, INFRARED = 0, 1
"""Types of radiation of sensor_msgs/Range."""
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
