"""What a run leaves behind: the trajectory at the control rate, and the named time series of the sensors."""

import math
import re
import zipfile
import zlib
from dataclasses import dataclass
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from symolo.core.finite import require_finite

MAX_UNPACKED_BYTES = 256 << 20
"""Largest size of all arrays of a recording together; a row takes less than a kilobyte."""
_ENCRYPTED = 1
_PACKED = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
_MAGIC = b"\x93NUMPY\x01\x00"
_HEADER = re.compile(
    rb"\{'descr': '([<|][biuf]\d)', 'fortran_order': (False|True), 'shape': \((\d{1,9}),(?: (\d{1,9}))?\), \} *\n"
)
"""Type, order and shape of one or two dimensions (numpy.lib.format)."""


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
    """A run: its trajectory and the series of its sensors and drive, at the same times."""

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
    def load(cls, file: BinaryIO) -> "Recording":
        """Read what `save` wrote.

        Raises:
            ValueError: An array has no rows of numbers, holds one that is not finite, or is too large.
            KeyError: An array is missing.
            zipfile.BadZipFile: It is no whole archive of arrays as `save` writes them.
        """
        arrays = _unpacked(file)
        for name, values in arrays.items():
            if values.dtype.kind not in "biuf" or values.ndim not in {1, 2}:
                raise ValueError(f"{name}: holds {values.dtype} of {values.ndim} dimensions, not rows of numbers")
            require_finite(values, name, ("row", "column")[: values.ndim])
        trajectory = Trajectory(arrays["t_s"], arrays["pose"], arrays["twist"], arrays["state"])
        keys = [name.removesuffix("/t_s") for name in arrays if name.startswith("series/") and name.endswith("/t_s")]
        series = []
        for key in keys:
            name, _, unit = key.removeprefix("series/").partition("/")
            series.append(TimeSeries(name, unit, arrays[f"{key}/t_s"], arrays[f"{key}/values"]))
        return cls(trajectory, tuple(series))


def _unpacked(file: BinaryIO) -> dict[str, NDArray[np.generic]]:
    """Return the arrays of an archive by name.

    `np.load` is not used: it takes memory for the shape that a header states before it looks whether there are as many
    bytes, and a small file may unpack to any number of them.
    """
    try:
        with zipfile.ZipFile(file) as archive:
            members = archive.infolist()
            if sum(member.file_size for member in members) > MAX_UNPACKED_BYTES:
                raise ValueError(f"unpacks to more than {MAX_UNPACKED_BYTES >> 20} MiB, which no trajectory does")
            if any(member.flag_bits & _ENCRYPTED or member.compress_type not in _PACKED for member in members):
                raise zipfile.BadZipFile("is packed in another way than a trajectory is")
            return {member.filename.removesuffix(".npy"): _array(archive.read(member)) for member in members}
    except (zlib.error, EOFError, NotImplementedError) as error:
        raise zipfile.BadZipFile(f"is damaged: {error}") from None


def _array(data: bytes) -> NDArray[np.generic]:
    """Return an array from the bytes of an .npy file (version 1.0), whose header is exactly as NumPy writes it."""
    begin = len(_MAGIC) + 2 + int.from_bytes(data[len(_MAGIC) : len(_MAGIC) + 2], "little")
    header = _HEADER.fullmatch(data, len(_MAGIC) + 2, begin) if data.startswith(_MAGIC) else None
    if header is None:
        raise zipfile.BadZipFile("holds an array whose header is none of a trajectory")
    kind, order, rows, columns = header.groups()
    dtype = np.dtype(kind.decode())
    shape = (int(rows), int(columns)) if columns else (int(rows),)
    if math.prod(shape) * dtype.itemsize != len(data) - begin:
        raise zipfile.BadZipFile(f"holds an array of {shape} with {len(data) - begin} bytes")
    return np.frombuffer(data, dtype, offset=begin).reshape(shape, order="F" if order == b"True" else "C")
