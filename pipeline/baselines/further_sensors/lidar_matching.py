"""Scan matching with a lidar, whose scans are straightened by the wheels: the robot drives while the head turns."""

import numpy as np

from pipeline.baselines.further_sensors.lidar_log import LidarLog
from pipeline.baselines.further_sensors.scan_filter import matched
from pipeline.baselines.further_sensors.scans import MatchedScan, OdometryPath, ScanLog
from pipeline.baselines.further_sensors.sensor_method import sensor_method

MAX_RAYS = 360
"""Number of rays of a scan that are matched; of more, every second, every third and so on is matched."""
RANGE_DIGIT_M = 1e-4
"""Last digit of a range in the table of a lidar."""


def scans_of(lidar: LidarLog, path: OdometryPath) -> ScanLog:
    """Return the scans in the frames of the rows that follow them."""
    settings, rays = lidar.settings, np.arange(0, lidar.settings.rays, -(-lidar.settings.rays // MAX_RAYS))
    angles = np.radians(settings.first_ray_deg + settings.ray_step_deg * rays)
    X_RS = settings.X_RS()
    directions_R = np.stack([np.cos(angles), np.sin(angles), np.zeros(len(rays))], axis=1) @ X_RS[:3, :3].T
    late_s = settings.sweep_s * (rays - settings.rays + 1) / settings.rays
    step_m = max(settings.quantisation_m, RANGE_DIGIT_M)
    scans: dict[int, MatchedScan] = {}
    for t_s, ranges_m in zip(lidar.t_s, lidar.ranges_m[:, rays], strict=True):
        row, (met,) = path.row_after(t_s), ranges_m.nonzero()
        if row is not None and len(met):
            at_s, range_m = t_s + late_s[met], ranges_m[met]
            origins = np.broadcast_to(X_RS[:3, 3], (len(met), 3))
            points = origins + range_m[:, None] * directions_R[met]
            sd_m = np.sqrt(settings.noise_m**2 + (settings.noise_share * range_m) ** 2 + step_m**2 / 12.0)
            seen = path.seen_from(row, at_s, origins), path.seen_from(row, at_s, points)
            scans[row] = MatchedScan(row, *seen, sd_m, np.zeros(len(met)), np.ones(len(met)))
    return ScanLog(tuple(scans.values()), settings.offset_sd_m)


METHOD = sensor_method(
    "lidar",
    "scan matching",
    "odometry, corrected by scans of the lidar by the map",
    log_of=lambda further: further.lidar,
    missing="the robot has no lidar: add one to robot.sensors",
    estimate=lambda knowledge, lidar: matched(knowledge, scans_of(lidar, OdometryPath(knowledge))),
)
