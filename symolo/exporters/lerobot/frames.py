"""The frames of LeRobot's episodes: evenly spaced, with an image each."""

import numpy as np

from symolo.core.errors import InputError
from symolo.exporters.shared.stereo import first_camera
from symolo.reader.camera_run import CameraRun
from symolo.reader.run import Run
from symolo.reader.run_folder import Image

_ROUNDED_S = 0.6e-3
"""Largest distance of an image from its period: times are rounded to milliseconds."""


def image_hz(run: Run) -> int:
    """Return the rate of a run's images, for a format whose frames must be evenly spaced.

    That of a recorded camera is its usual one.

    Raises:
        InputError: They are not, as those of an imported trajectory with rows at any times, or the rate is no integer.
    """
    if run.spec.rates:
        if not (rate_hz := float(run.spec.rates.camera_hz)).is_integer():
            what = f"run {run.name}: images are at {rate_hz:g} Hz, and the rate of this format is an integer"
            raise InputError(what, where=str(run.folder), cure="render it again with `symolo rerender --camera-hz`")
        return int(rate_hz)
    camera = first_camera(run)
    if isinstance(camera, CameraRun):
        return max(1, round(1 / camera.settings.period_s))
    t_s = np.array([image.t_s for image in run.images])
    hz = max(1, round((len(t_s) - 1) / (t_s[-1] - t_s[0]))) if len(t_s) > 1 else 1
    late_s = np.abs(t_s - t_s[0] - np.arange(len(t_s)) / hz)
    if late_s.max() > _ROUNDED_S:
        what = f"run {run.name}: images are not at {hz} Hz, but up to {late_s.max():.3g} s off"
        raise InputError(what, where=str(run.folder), cure="import the log with --row-hz, and render it again")
    return hz


def images_of_frames(run: Run) -> tuple[Image, ...]:
    """Return the image of each frame. Of a recorded camera, whose times are uneven, it is the nearest one in time."""
    camera = first_camera(run)
    images = camera.images
    if not isinstance(camera, CameraRun):
        return images
    t_s, period_s = np.array([image.t_s for image in images]), 1 / image_hz(run)
    frames_s = np.arange(t_s[0], t_s[-1] + 0.5 * period_s, period_s)
    return tuple(images[i] for i in np.searchsorted(0.5 * (t_s[1:] + t_s[:-1]), frames_s).tolist())
