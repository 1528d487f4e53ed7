"""Camera and poses of pictures of an earlier `rerender`, which wrote no side/: of the job they were rendered from."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from blender_scenes.render.job import RenderJob
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.pinhole import matrix_K
from symolo.core.poses import pose_X_WR
from symolo.dataset.camera_model import X_CB, CameraModel
from symolo.dataset.layout import JOB

_DECIMALS = 9


def read_job(folder: Path, numbers: Sequence[int]) -> RenderJob:
    """What the images with these numbers were rendered from.

    Raises:
        InputError: job.json is missing or damaged, or is of other images.
    """
    path = folder / JOB
    try:
        job = RenderJob.from_json(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", where=str(path)) from None
    except ValueError as error:
        raise InputError(f"is damaged: {str(error).splitlines()[0]}", where=str(path), cure="rerender again") from None
    if [view.number for view in job.frames] != [*numbers]:
        raise InputError("is of other images than data.csv", where=str(path), cure="rerender again")
    return job


def poses_of(job: RenderJob) -> Array:
    """(images, 4, 4), X_WC at each shutter."""
    return np.array([view.X_WC for view in job.frames]).reshape(-1, 4, 4)


def camera_of(job: RenderJob) -> CameraModel:
    """As intrinsics.json of a release tells it; of a job that has a frame."""
    camera, view = job.camera, job.frames[0]
    X_RC = np.linalg.inv(pose_X_WR(*view.robot_pose)) @ np.array(view.X_WC)
    return CameraModel.model_validate(
        {
            "width_px": camera.width_px,
            "height_px": camera.height_px,
            "K": (np.round(matrix_K(camera), _DECIMALS) + 0.0).tolist(),
            "D": camera.distortion,
            "exposure_s": job.shutter.exposure_s,
            "read_out_s": job.shutter.read_out_s,
            "X_RC": (np.round(X_RC, _DECIMALS) + 0.0).tolist(),
            "X_CB": X_CB,
        }
    )
