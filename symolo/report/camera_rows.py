"""Images of all cameras of a run at a few moments, side by side."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from symolo.exporters.shared.stereo import pair_first
from symolo.pages.thumbnails import thumbnail
from symolo.reader.run import Run
from symolo.reader.run_folder import Image
from symolo.report.statistics.run_facts import fresh

MAX_MOMENTS = 3


@dataclass(frozen=True)
class CameraImage:
    """The newest image of a camera at a moment."""

    camera: str
    number: int
    t_s: float
    jpeg: bytes


def camera_rows(run: Run) -> tuple[tuple[CameraImage, ...], ...]:
    """Return a row of images for each of a few moments, spread over the run; none without further cameras.

    Raises:
        InputError: An image cannot be decoded.
    """
    run = fresh(run)
    # Of runs that are simulated only, further cameras have neither images nor intrinsics yet.
    if not any(image.path.is_file() for camera in run.cameras.values() for image in camera.images[:1]):
        return ()
    cameras = pair_first(run)
    moments_s = float(run.t_s[-1]) * (np.arange(MAX_MOMENTS) + 0.5) / MAX_MOMENTS
    return tuple(
        tuple(_shown(name, _newest(camera.images, at_s)) for name, camera in cameras.items())
        for at_s in moments_s.tolist()
    )


def _newest(images: Sequence[Image], at_s: float) -> Image:
    return [images[0], *(image for image in images if image.t_s <= at_s)][-1]


def _shown(camera: str, image: Image) -> CameraImage:
    return CameraImage(camera, image.number, image.t_s, thumbnail(image))
