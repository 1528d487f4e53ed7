"""Scan matching with a stereo pair, whose points are scans."""

import numpy as np

from pipeline.baselines.further_sensors.scan_filter import matched
from pipeline.baselines.further_sensors.scans import MatchedScan, OdometryPath, ScanLog
from pipeline.baselines.further_sensors.sensor_method import sensor_method
from pipeline.baselines.further_sensors.stereo_log import StereoLog

SD_PX = 0.7
"""Standard deviation [px] of a disparity."""
SHARED_SD_PX = 0.5
"""Standard deviation [px] of the error that the disparities of one surface share: semi-global matching smooths."""
LASTING_SD_PX = 0.1
"""Standard deviation [px] of the error of all disparities of a run, by which matching prefers some fractions."""
MIN_HEIGHT_M = 0.02
"""Height [m] below which a point is of the floor, which shows no position."""
MAX_DEPTH_M = 3.0
"""Largest depth [m] of a point that is used."""
MAX_POINTS = 400
"""Number of points of a pair of images that are matched; of more, every second, every third and so on is matched."""


def scans_of(stereo: StereoLog, path: OdometryPath) -> ScanLog:
    """Return the points of all pairs in the frames of the rows that follow them."""
    scans: dict[int, MatchedScan] = {}
    place_R = stereo.X_RC[:3, 3]
    for index, t_s in enumerate(stereo.t_s.tolist()):
        row = path.row_after(t_s)
        if row is None:
            continue
        points, depth_m = stereo.points(index)
        (used,) = ((points[:, 2] > MIN_HEIGHT_M) & (depth_m < MAX_DEPTH_M)).nonzero()
        used = used[:: max(1, -(-len(used) // MAX_POINTS))]
        if len(used):
            # A pixel more of disparity is a share of d / (f b) less of the range.
            by_px = -np.linalg.norm(points[used] - place_R, axis=1) * depth_m[used] / stereo.focal_baseline_m_px
            at_s, origins = np.full(len(used), t_s), np.broadcast_to(place_R, (len(used), 3))
            seen = path.seen_from(row, at_s, origins), path.seen_from(row, at_s, points[used])
            scans[row] = MatchedScan(row, *seen, SD_PX * np.abs(by_px), SHARED_SD_PX * np.abs(by_px), by_px)
    return ScanLog(tuple(scans.values()), LASTING_SD_PX)


METHOD = sensor_method(
    "stereo",
    "stereo matching",
    "odometry, corrected by stereo depth that agrees with the map",
    log_of=lambda further: further.stereo,
    missing="there are no images of a rectified stereo pair: release a robot with two equal cameras side by side",
    estimate=lambda knowledge, stereo: matched(knowledge, scans_of(stereo, OdometryPath(knowledge))),
)
