"""Points at which the rays of a lidar met something."""

import numpy as np

from symolo.core.arrays import Array
from symolo.core.geometry.poses import rotations_about_z
from symolo.dataset.documents.sensor_sections import LidarSection
from symolo.dataset.tables.camera_rows import path_of
from symolo.reader.run import Run
from symolo.reader.sensor import RunSensor


def scan_points(run: Run, lidar: RunSensor) -> Array:
    """Return the places in W (scans, rays, 3) [m] of what each ray met, NaN without a return.

    Each ray starts from the pose of the robot at its own time, so that a turn of the robot during a scan bends nothing.
    """
    settings = LidarSection.model_validate(lidar.settings)
    rays = np.arange(settings.rays)
    angles_rad = np.radians(settings.first_ray_deg + settings.ray_step_deg * rays)
    directions_S = np.stack([np.cos(angles_rad), np.sin(angles_rad), np.zeros(len(rays))], axis=1)
    range_m = np.where(lidar.no_target, np.nan, lidar.values("range").reshape(-1, len(rays)))
    points_R = lidar.X_RS[:3, 3] + range_m[..., None] * (directions_S @ lidar.X_RS[:3, :3].T)
    late_s = settings.sweep_s / len(rays) * (rays - len(rays) + 1)  # the last ray is measured at t
    poses = path_of(run.table).poses_at((lidar.t_s[:, None] + late_s).ravel())
    turned = np.einsum("nij,nj->ni", rotations_about_z(poses[:, 2]), points_R.reshape(-1, 3))
    turned[:, :2] += poses[:, :2]
    return turned.reshape(points_R.shape)
