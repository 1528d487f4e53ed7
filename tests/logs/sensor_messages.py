"""Messages of a laser scanner and an IMU on a robot that drives in a circle."""

import math

import numpy as np

from symolo.core.geometry.poses import pose_X_WR, transform_of
from tests.logs.written_bags import POSE, START_NS, T_S

RAYS, STEP_RAD, RAY_S = 8, math.radians(40.0), 0.004
SCANS = 10
X_RL = transform_of((-0.03, 0.02, 0.18), (math.pi, 0.0, 0.5 * math.pi))
"""A scanner that hangs upside down and looks to the left."""
X_RI = transform_of((0.01, 0.0, 0.05), (0.0, math.radians(-30.0), 0.0))
"""An IMU whose x axis points upwards by 30 degrees."""


def ranges(number):
    """Returns, and what devices state in their place (REP 117): none, none as 0, a failure, too close, too far."""
    return [1.25 + 0.1 * number, math.inf, 0.0, math.nan, 0.05, 9.0, 2.5, 0.1234]


def scan(ros, at_ns, number, *, light=True, rays=RAYS):
    return ros(
        "sensor_msgs/LaserScan",
        header=ros.header(at_ns, "laser"),
        angle_min=-math.pi,
        angle_max=-math.pi + STEP_RAD * (rays - 1),
        angle_increment=STEP_RAD,
        time_increment=RAY_S,
        scan_time=0.2,
        range_min=0.1,
        range_max=8.0,
        ranges=np.array(ranges(number)[:rays], np.float32),
        intensities=np.arange(rays if light else 0, dtype=np.float32) + number,
    )


def imu(ros, at_ns, rate, *, has_acceleration=True):
    known = np.zeros(9)
    unknown = np.array([-1.0, *np.zeros(8)])
    return ros(
        "sensor_msgs/Imu",
        header=ros.header(at_ns, "imu_link"),
        orientation=ros("geometry_msgs/Quaternion", x=0.0, y=0.0, z=0.0, w=1.0),
        orientation_covariance=unknown,
        angular_velocity=ros("geometry_msgs/Vector3", x=0.1, y=-0.2, z=rate),
        angular_velocity_covariance=known,
        linear_acceleration=ros("geometry_msgs/Vector3", x=0.0, y=0.25, z=9.81),
        linear_acceleration_covariance=known if has_acceleration else unknown,
    )


def messages(ros, **parts):
    """Poses at 20 Hz, an IMU at 100 Hz, scans at 5 Hz; the scanner is on the turret, the turret on the robot."""
    links = [("base_link", "turret", pose_X_WR(-0.03, 0.02, 0.0)), ("base_link", "imu_link", X_RI)]
    links.append(("turret", "laser", np.linalg.inv(links[0][2]) @ X_RL))
    for parent, child, X in links if parts.pop("mounted", True) else ():
        yield START_NS, "/tf_static", ros.transform(START_NS, parent, child, X)
    for number, (t_s, pose) in enumerate(zip(T_S.tolist(), POSE.tolist(), strict=True)):
        at_ns = START_NS + round(1e9 * t_s)
        yield at_ns, "/tf", ros.transform(at_ns, "odom", "base_link", pose_X_WR(*pose))
        for k in range(5):
            later_ns = at_ns + 10_000_000 * k
            yield later_ns, "/imu/data", imu(ros, later_ns, 0.5 + 0.001 * number, **parts.get("imu", {}))
        if number % 4 == 0 and number < 4 * SCANS:
            yield at_ns, "/scan", scan(ros, at_ns, number // 4, **parts.get("scan", {}))
