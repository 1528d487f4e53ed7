"""What a run leaves behind: the trajectory at the control rate, and the named time series of the sensors."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


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
        if np.any(np.diff(self.t_s) <= 0):
            raise ValueError(f"series {self.name}: time is not strictly increasing")
        self.t_s.flags.writeable = False
        self.values.flags.writeable = False


@dataclass(frozen=True)
class Trajectory:
    """Rows at the control rate; X_WR is the pose of the robot frame R (middle of the axle) in W."""

    t_s: NDArray[np.float64]
    """(N,), [s]."""
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
        for array in (self.t_s, self.pose, self.twist, self.state):
            array.flags.writeable = False
