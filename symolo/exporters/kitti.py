"""Sequences in the format of the KITTI odometry benchmark: poses of the camera, times, calibration, images.

`poses/NN.txt` has a line of 12 numbers for each image: the first three rows of X_C0C, the pose of the camera in C0, its
frame at the first image; `sequences/NN/` has times.txt [s], calib.txt and image_0/
(Geiger, Lenz, Urtasun, CVPR 2012; the benchmark's development kit).
"""

from collections.abc import Iterator

import numpy as np

from symolo.core.arrays import Array
from symolo.exporters.base import ExportedFile, Exporter, ExportSettings, check_images, copied_file
from symolo.reader.dataset import Dataset
from symolo.reader.run import Run


def _files(data: Dataset, _settings: ExportSettings) -> Iterator[ExportedFile]:
    check_images(data)
    digits = max(2, len(str(len(data.runs) - 1)))
    names = {f"{number:0{digits}d}": run for number, run in enumerate(data.runs)}
    yield ExportedFile("runs.txt", lambda: "".join(f"{name} {run.name}\n" for name, run in names.items()).encode())
    for name, run in names.items():
        folder = f"sequences/{name}"
        yield ExportedFile(f"poses/{name}.txt", lambda run=run: _lines(_relative(run.X_WC)))
        yield ExportedFile(f"{folder}/times.txt", lambda run=run: _lines([[image.t_s] for image in run.images]))
        yield ExportedFile(f"{folder}/origin.txt", lambda run=run: _lines(run.X_WC[:1, :3].reshape(1, 12)))
        yield ExportedFile(f"{folder}/calib.txt", lambda run=run: _calibration(run))
        for index, image in enumerate(run.images):
            yield copied_file(f"{folder}/image_0/{index:06d}{image.path.suffix}", image.path)


def _relative(X_WC: Array) -> Array:
    """Return the rows of X_C0C, (N, 12), for poses X_WC (N, 4, 4)."""
    X_C0C = np.linalg.inv(X_WC[0]) @ X_WC
    return X_C0C[:, :3].reshape(-1, 12)


def _calibration(run: Run) -> bytes:
    """Return calib.txt with P0 = K (I | 0).

    The benchmark has four cameras, so P1 to P3 repeat P0. Its Tr transforms from the frame of a laser scanner to the
    camera; here it transforms from R.
    """
    camera = run.camera
    P0 = np.column_stack((np.array(camera.K), np.zeros(3))).ravel()
    X_CR = np.linalg.inv(np.array(camera.X_RC))[:3].ravel()
    entries = {**{f"P{number}": P0 for number in range(4)}, "Tr": X_CR, "D0": camera.D}
    return b"".join(f"{name}: ".encode() + _lines([numbers]) for name, numbers in entries.items())


def _lines(table) -> bytes:  # noqa: ANN001 - rows of numbers, an array or lists
    """Return numbers as the benchmark writes them, with more digits and without negative zeros."""
    rows = np.round(np.asarray(table, dtype=np.float64), 12) + 0.0
    return "".join(" ".join(f"{value:.9e}" for value in row) + "\n" for row in rows.tolist()).encode()


EXPORTER = Exporter(
    "kitti", "sequences in the form of KITTI's odometry benchmark: poses, times, calibration, images", _files
)
