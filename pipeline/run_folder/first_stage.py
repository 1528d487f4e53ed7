"""What the first stage of a run leaves in its folder: the recording of a simulation, or tables from elsewhere."""

from pathlib import Path

from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.tables.time_series import Recording

TRAJECTORY = "trajectory.npz"
"""File with the recording of a simulation."""
TAKEN = "taken"
"""Folder with the tables of a trajectory that was not simulated here."""


def is_external(folder: Path) -> bool:
    """Return whether the first stage of a run holds tables in the place of a simulation."""
    return (folder / TAKEN).is_dir()


def has_trajectory(folder: Path) -> bool:
    """Return whether a folder is the finished first stage of a run."""
    return (folder / TRAJECTORY).is_file() or is_external(folder)


def read_recording(folder: Path) -> Recording:
    """Return the recording of a simulation.

    Raises:
        OSError: The file is missing.
        ValueError: It is damaged.
    """
    # All bytes are read first, because the unpacker would report a fault of the disk as a damaged archive.
    return Recording.load(read_file(folder / TRAJECTORY, FileKind.TRAJECTORY))
