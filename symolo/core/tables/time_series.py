"""Record of a run: the trajectory at the control rate, and the named time series of the sensors."""

from dataclasses import dataclass
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from symolo.core.files.npz_file import arrays_of
from symolo.core.files.plain_files import FileKind
from symolo.core.finite import require_finite


@dataclass(frozen=True)
class TimeSeries:
    """One measured or simulated channel."""

    name: str
    unit: str
    t_s: NDArray[np.float64]
    """(N,), [s], strictly increasing."""
    values: NDArray[np.float64] | NDArray[np.int64]
    """(N,) or (N, K), in `unit`."""

    def __post_init__(self) -> None:
        if self.t_s.ndim != 1 or len(self.values) != len(self.t_s):
            raise ValueError(f"series {self.name}: {len(self.values)} values for {self.t_s.shape} times")
        if (self.t_s[1:] <= self.t_s[:-1]).any():
            raise ValueError(f"series {self.name}: time is not strictly increasing")
        self.t_s.flags.writeable = False
        self.values.flags.writeable = False


@dataclass(frozen=True)
class Trajectory:
    """Rows at the control rate; X_WR is the pose of the robot frame R (middle of the axle) in W."""

    t_s: NDArray[np.float64]
    """(N,), [s], strictly increasing."""
    pose: NDArray[np.float64]
    """(N, 3), x [m], y [m], yaw [rad] in W, yaw unwrapped."""
    twist: NDArray[np.float64]
    """(N, 2), forward speed v [m/s], yaw rate w [rad/s]."""
    state: NDArray[np.int64]
    """(N,), the state numbers of data.csv."""

    def __post_init__(self) -> None:
        rows = len(self.t_s)
        shapes = {"pose": (rows, 3), "twist": (rows, 2), "state": (rows,)}
        for name, shape in shapes.items():
            array = getattr(self, name)
            if array.shape != shape:
                raise ValueError(f"trajectory {name}: shape {array.shape}, expected {shape}")
        if np.any(np.diff(self.t_s) <= 0):
            raise ValueError("trajectory: time is not strictly increasing")
        for array in (self.t_s, self.pose, self.twist, self.state):
            array.flags.writeable = False


@dataclass(frozen=True)
class Recording:
    """A run: its trajectory, series of sensors and drive at the same times, and samples at times of their own."""

    trajectory: Trajectory
    series: tuple[TimeSeries, ...]

    def __getitem__(self, name: str) -> TimeSeries:
        for series in self.series:
            if series.name == name:
                return series
        raise KeyError(f"no series {name!r}; there are {', '.join(s.name for s in self.series)}")

    def save(self, file: BinaryIO) -> None:
        """Write as npz; the same recording gives the same arrays, the archive's time stamps are fixed by numpy."""
        trajectory = self.trajectory
        arrays: dict[str, NDArray[np.float64] | NDArray[np.int64]] = {
            "t_s": trajectory.t_s,
            "pose": trajectory.pose,
            "twist": trajectory.twist,
            "state": trajectory.state,
        }
        for series in self.series:
            arrays[f"series/{series.name}/{series.unit}/t_s"] = series.t_s
            arrays[f"series/{series.name}/{series.unit}/values"] = series.values
        np.savez_compressed(file, **arrays)  # pyright: ignore[reportArgumentType]

    @classmethod
    def load(cls, data: bytes) -> "Recording":
        """Read what `save` wrote.

        Raises:
            ValueError: An array has no rows of numbers, or holds one that is not finite; or the arrays are too large.
            KeyError: An array is missing.
            zipfile.BadZipFile: It is no whole archive.
        """
        arrays = arrays_of(data, FileKind.TRAJECTORY.max_bytes)
        for name, values in arrays.items():
            require_finite(values, name, ("row", "column")[: values.ndim])
        trajectory = Trajectory(arrays["t_s"], arrays["pose"], arrays["twist"], arrays["state"])
        keys = [name.removesuffix("/t_s") for name in arrays if name.startswith("series/") and name.endswith("/t_s")]
        series = []
        for key in keys:
            _, name, unit = key.split("/", 2)
            series.append(TimeSeries(name, unit, arrays[f"{key}/t_s"], arrays[f"{key}/values"]))
        return cls(trajectory, tuple(series))
