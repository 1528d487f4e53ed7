"""The cameras of a run, and the two of them that are a rectified stereo pair."""

from dataclasses import dataclass
from itertools import permutations

import numpy as np

from symolo.reader.run import Run
from symolo.reader.run_folder import RunFolder

OWN_CAMERA = "camera"
"""Name of the camera of data.csv; no further camera may have it."""
_SAME_M = 2e-6
"""Largest difference of places in directions in which they must be equal; files have six digits."""
_SAME_DIRECTION = 1e-6


@dataclass(frozen=True)
class StereoPair:
    """Two cameras whose rows of pixels see the same: equal pinhole lenses without distortion, side by side."""

    left: str
    right: str
    baseline_m: float
    """Distance from the left to the right camera along x of C."""


def cameras_with_images(run: Run) -> dict[str, RunFolder]:
    """Return the cameras of a run that took images: that of data.csv first, the further ones by name."""
    cameras: dict[str, RunFolder] = {OWN_CAMERA: run, **run.cameras}
    return {name: camera for name, camera in cameras.items() if camera.numbers}


def first_camera(run: Run) -> RunFolder:
    """Return the camera of data.csv, or the first further one by name if only others took images, as in a log."""
    return next(iter(cameras_with_images(run).values()), run)


def stereo_pair(run: Run) -> StereoPair | None:
    """Return the first rectified pair in the order of `cameras_with_images`; None if there is none."""
    cameras = cameras_with_images(run)
    for left, right in permutations(cameras, 2):
        baseline_m = _baseline_m(cameras[left], cameras[right])
        if baseline_m is not None:
            return StereoPair(left, right, baseline_m)
    return None


def pair_first(run: Run) -> dict[str, RunFolder]:
    """Return `cameras_with_images` with the left and the right camera of the pair first, if there is one."""
    cameras, pair = cameras_with_images(run), stereo_pair(run)
    first = (pair.left, pair.right) if pair else ()
    return {name: cameras[name] for name in (*first, *(other for other in cameras if other not in first))}


def _baseline_m(left: RunFolder, right: RunFolder) -> float | None:
    """Return the baseline of two cameras if they are a rectified pair."""
    right_document = right.camera.document
    same_lens = left.camera.document.model_copy(update={"X_RC": right_document.X_RC}) == right_document
    if not same_lens or left.camera.camera_model != "pinhole" or any(left.camera.D):
        return None
    if [image.t_s for image in left.images] != [image.t_s for image in right.images]:
        return None
    X_LR = np.linalg.inv(left.camera.X_RC) @ right.camera.X_RC
    x_m, y_m, z_m = X_LR[:3, 3].tolist()
    is_aside = x_m > _SAME_M and max(abs(y_m), abs(z_m)) < _SAME_M
    return x_m if is_aside and np.allclose(X_LR[:3, :3], np.eye(3), rtol=0, atol=_SAME_DIRECTION) else None
