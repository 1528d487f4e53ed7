"""All readers of trajectories in logs, in the order in which they are tried."""

from logs.trajectories import bag, euroc, kitti, motive, symolo_csv, table, tum
from logs.trajectories.base import TrajectoryReader

READERS: tuple[TrajectoryReader, ...] = (
    bag.READER,
    symolo_csv.READER,
    tum.READER,
    kitti.READER,
    euroc.READER,
    motive.READER,
    table.READER,
)
"""Readers in the order in which they are tried; a table of any kind comes last."""
