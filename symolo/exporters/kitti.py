"""Sequences in the format of the KITTI odometry benchmark: poses of the camera, times, calibration, images.

`poses/NN.txt` has a line of 12 numbers for each image: the first three rows of X_C0C, the pose of the camera in C0, its
frame at the first image; `sequences/NN/` has times.txt [s], calib.txt, image_0/, and image_1/ of a rectified pair
(Geiger, Lenz, Urtasun, CVPR 2012; the benchmark's development kit).
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from symolo.core.arrays import Array
from symolo.exporters.base import ExportedFile, Exporter, ExportSettings, check_images, copied_file
from symolo.exporters.shared.stereo import StereoPair, cameras_with_images, first_camera, stereo_pair
from symolo.reader.dataset import Dataset
from symolo.reader.run import Run
from symolo.reader.run_folder import RunFolder


@dataclass(frozen=True)
class _Sequence:
    """The cameras of a run that are exported."""

    cameras: tuple[RunFolder, ...]
    """The left and the right camera of a pair, or the only one."""
    baseline_m: float

    @classmethod
    def from_run(cls, run: Run, pair: StereoPair | None) -> "_Sequence":
        if pair is None:
            return cls((first_camera(run),), 0.0)
        cameras = cameras_with_images(run)
        return cls((cameras[pair.left], cameras[pair.right]), pair.baseline_m)


def _pairs(data: Dataset) -> list[StereoPair | None]:
    """Return the rectified pair of each run; all sequences have the same folders, so all or none have one."""
    pairs = [stereo_pair(run) for run in data.runs]
    same = len({pair and (pair.left, pair.right) for pair in pairs}) <= 1
    return pairs if same else [None] * len(pairs)


def _warnings(data: Dataset) -> Iterator[str]:
    cameras = [_Sequence.from_run(run, pair).cameras[0] for run, pair in zip(data.runs, _pairs(data), strict=True)]
    if any(camera.camera.camera_model == "fisheye" or camera.camera.D.any() for camera in cameras):
        yield "the lens has distortion, and images are not undistorted: readers of KITTI do not know D0 in calib.txt"


def _files(data: Dataset, _settings: ExportSettings) -> Iterator[ExportedFile]:
    pairs = _pairs(data)
    check_images(data, "kitti")
    digits = max(2, len(str(len(data.runs) - 1)))
    names = {f"{number:0{digits}d}": run for number, run in enumerate(data.runs)}
    yield ExportedFile("runs.txt", lambda: "".join(f"{name} {run.name}\n" for name, run in names.items()).encode())
    for (name, run), pair in zip(names.items(), pairs, strict=True):
        folder, sequence = f"sequences/{name}", _Sequence.from_run(run, pair)
        camera = sequence.cameras[0]
        yield ExportedFile(f"poses/{name}.txt", lambda camera=camera: _lines(_relative(camera.X_WC)))
        times = f"{folder}/times.txt"
        yield ExportedFile(times, lambda camera=camera: _lines([[image.t_s] for image in camera.images]))
        origin = f"{folder}/origin.txt"
        yield ExportedFile(origin, lambda camera=camera: _lines(camera.X_WC[:1, :3].reshape(1, 12)))
        yield ExportedFile(f"{folder}/calib.txt", lambda sequence=sequence: _calibration(sequence))
        for number, one in enumerate(sequence.cameras):
            for image in one.images:
                place = f"{folder}/image_{number}/{image.index:06d}{image.path.suffix}"
                yield copied_file(place, image.path)


def _relative(X_WC: Array) -> Array:
    """Return the rows of X_C0C, (N, 12), for poses X_WC (N, 4, 4)."""
    X_C0C = np.linalg.inv(X_WC[0]) @ X_WC
    return X_C0C[:, :3].reshape(-1, 12)


def _calibration(sequence: _Sequence) -> bytes:
    """Return calib.txt with P0 = K (I | 0), and P1 = K (I | p) with the place p of the right camera, negated.

    The benchmark has four cameras, two grey and two in colour, so P2 and P3 repeat P0 and P1. Its Tr transforms from
    the frame of a laser scanner to the camera; here it transforms from R.
    """
    camera = sequence.cameras[0].camera
    K = camera.K
    P0, P1 = (np.column_stack((K, K @ [-baseline_m, 0.0, 0.0])).ravel() for baseline_m in (0.0, sequence.baseline_m))
    X_CR = np.linalg.inv(camera.X_RC)[:3].ravel()
    entries = {"P0": P0, "P1": P1, "P2": P0, "P3": P1, "Tr": X_CR, "D0": camera.D}
    return b"".join(f"{name}: ".encode() + _lines([numbers]) for name, numbers in entries.items())


def _lines(table) -> bytes:  # noqa: ANN001 - rows of numbers, an array or lists
    """Return numbers as the benchmark writes them, with more digits and without negative zeros."""
    rows = np.round(np.asarray(table, dtype=np.float64), 12) + 0.0
    return "".join(" ".join(f"{value:.9e}" for value in row) + "\n" for row in rows.tolist()).encode()


EXPORTER = Exporter(
    "kitti", "sequences in the form of KITTI's odometry benchmark: poses, times, calibration, images", _files, _warnings
)
