"""Ground truth of the EuRoC MAV datasets: `data.csv` with `p_RS_R` and `q_RS`, or its folder.

S is the sensor whose pose is given in R, the world; times are in ns
(Burri et al., The EuRoC micro aerial vehicle datasets, IJRR 2016).
"""

from pathlib import Path

import numpy as np

from logs.log_file import read_log
from logs.recognition import first_line, is_file, is_folder
from logs.trajectories.base import LoggedTrajectory, ReadSettings, TrajectoryReader
from logs.trajectories.planar import on_floor
from symolo.core.errors import InputError
from symolo.core.geometry.poses import rotations
from symolo.core.tables.pose_lines import check_times

_FOLDERS = ("", "mav0/state_groundtruth_estimate0", "state_groundtruth_estimate0", "mav0/vicon0", "mav0/mocap0")
_START = "#timestamp[ns],p_RS_R_x[m],p_RS_R_y[m],p_RS_R_z[m],q_RS_w[],q_RS_x[],q_RS_y[],q_RS_z[]"
_PLACE = tuple(f"p_RS_R_{axis} [m]" for axis in "xyz")
_ROTATION = tuple(f"q_RS_{axis} []" for axis in "xyzw")


def _file(path: Path) -> Path | None:
    """Return the file itself, or the ground truth in a folder; None if there is none."""
    places = [path / folder / "data.csv" for folder in _FOLDERS] if is_folder(path) else [path]
    return next((place for place in places if is_file(place) and first_line(place).startswith(_START)), None)


def _read(path: Path, settings: ReadSettings) -> list[LoggedTrajectory]:
    file = _file(path)
    if file is None:
        raise InputError("holds no ground truth of EuRoC", where=str(path), allowed=f"a data.csv that begins {_START}")
    log = read_log(file)
    # Some files have spaces in front of units, and some do not.
    names = {"".join(name.split()): name for name in log.columns}

    def column(name: str) -> np.ndarray:
        return log.numbers(names["".join(name.split())])

    p_OB = np.column_stack([column(name) for name in _PLACE])
    quaternion = np.column_stack([column(name) for name in _ROTATION])
    # The digits of ns since 1970 exceed those of a float, so the first time is taken off as an integer.
    cells = log.columns[names["timestamp[ns]"]]
    try:
        t_ns = np.array([int(cell) for cell in cells])
    except ValueError:
        t_ns = column("timestamp[ns]")
    t_s = 1e-9 * (t_ns - t_ns[0])
    check_times(t_s, list(range(2, len(t_s) + 2)), file)
    if not np.isfinite(p_OB).all() or not np.isfinite(quaternion).all():
        raise InputError("a pose is missing", where=str(file), cure="remove rows without a pose")
    floor = on_floor(p_OB, rotations(quaternion), str(file), up=settings.up, forward=settings.forward)
    quantities = {"t": "timestamp, in ns", **floor.quantities}
    changes = (*log.notes, *floor.changes)
    return [
        LoggedTrajectory(t_s, floor.pose, quantities, changes=changes, guesses=floor.guesses, warnings=floor.warnings)
    ]


READER = TrajectoryReader(
    "euroc", "ground truth of the EuRoC MAV datasets", lambda path: _file(path) is not None, _read
)
