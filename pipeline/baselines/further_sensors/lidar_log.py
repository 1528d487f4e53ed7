"""The scans of a lidar, and the sizes of its errors as its description states them."""

from dataclasses import dataclass

from sensors.ranging.lidar import LidarSettings
from symolo.core.arrays import Array


@dataclass(frozen=True)
class LidarLog:
    """All scans of one lidar in a run, M scans of the same number of rays."""

    t_s: Array
    """(M,), time [s] of the last ray of each scan."""
    ranges_m: Array
    """(M, rays), ranges [m]; 0 without a return."""
    settings: LidarSettings
    """Place, directions and sizes of the errors in the description of the robot; the errors are not known."""

    @classmethod
    def from_table(cls, settings: LidarSettings, table: Array) -> "LidarLog":
        """Return the log in the table of a lidar, (M, columns) with the time [ms] first."""
        return cls(table[:, 0] / 1000, table[:, 1 : 1 + settings.rays], settings)
