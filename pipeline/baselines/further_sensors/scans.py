"""Points that a range sensor of many rays has seen, such as a lidar or a stereo pair, scan by scan."""

from dataclasses import dataclass

import numpy as np

from pipeline.baselines.motion import WheelMotion, rolled_distances_m
from pipeline.baselines.robot_knowledge import RobotKnowledge
from symolo.core.arrays import Array
from symolo.core.geometry.poses import rotations_about_z


@dataclass(frozen=True)
class MatchedScan:
    """Rays with a return, in the frame R of the robot at one row of data.csv."""

    row: int
    """Row of data.csv, the first one that is not before the last ray."""
    origins_R: Array
    """(K, 3), places of the sensor when it measured the rays."""
    points_R: Array
    """(K, 3), what the rays met by their readings."""
    sd_m: Array
    """(K,), standard deviation of each range, new in each scan."""
    shared_sd_m: Array
    """(K,), standard deviation of an error of each range that all rays on one surface share in this scan."""
    by_lasting: Array
    """(K,), change of each range by the lasting error of the sensor."""


@dataclass(frozen=True)
class ScanLog:
    """The scans of a run, ready to be matched with the map."""

    scans: tuple[MatchedScan, ...]
    """Scans in the order of time, at most one for each row."""
    lasting_sd: float
    """Standard deviation of the lasting error of the sensor, in its own unit."""


class OdometryPath:
    """The motion of the robot by the counts of its encoders, which places rays that it measured while it drove."""

    def __init__(self, knowledge: RobotKnowledge) -> None:
        motion, state, poses = WheelMotion.from_knowledge(knowledge), np.zeros(6), []
        for rolled_m in rolled_distances_m(knowledge):
            state = motion.moved(state, rolled_m)
            poses.append(state[:3])
        self._t_s, self._poses = knowledge.t_s, np.array(poses)

    def row_after(self, t_s: float) -> int | None:
        """Return the first row that is not before a time."""
        row = int(np.searchsorted(self._t_s, t_s - 1e-6))
        return row if row < len(self._t_s) else None

    def seen_from(self, row: int, t_s: Array, places_R: Array) -> Array:
        """Return places (K, 3) in R at the times (K,), in R at a row."""
        at = np.column_stack([np.interp(t_s, self._t_s, column) for column in self._poses.T])
        here = self._poses[row]
        turned = np.einsum("kij,kj->ki", rotations_about_z(at[:, 2] - here[2]), places_R)
        moved = np.column_stack((at[:, :2] - here[:2], np.zeros(len(at))))
        return turned + moved @ rotations_about_z(here[2:])[0]
