"""Images of LeRobot's episodes as MP4 files with H.264, one file beside each file of frames."""

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from symolo.core.errors import InputError
from symolo.core.extras import optional_module
from symolo.reader.run_folder import Image, RunFolder

_KEY_FRAME_EVERY = 2
"""Distance of key frames, as in LeRobot's own videos: loaders read frames in any order."""


def check_video(runs: Sequence[RunFolder]) -> None:
    """Refuse runs whose images of a camera do not fit into one kind of video.

    Raises:
        EnvironmentLacking: The extra `video` is not installed.
        InputError: The sizes of images differ or are odd.
    """
    optional_module("av")
    first = runs[0].camera
    for run in runs:
        size = run.camera.width_px, run.camera.height_px
        if size != (first.width_px, first.height_px):
            what, cure = "has images of a different size than the first run", "export them separately with --runs"
            raise InputError(what, where=str(run.folder), cure=cure)
        if any(length_px % 2 for length_px in size):
            what = f"run {run.name} has images of {size[0]} x {size[1]} px"
            raise InputError(what, where="--video", allowed="even widths and heights", cure="leave out --video")


def video_info(run: RunFolder, hz: int) -> dict[str, Any]:
    """Return the description of the videos, as info.json has it."""
    return {
        "video.height": run.camera.height_px,
        "video.width": run.camera.width_px,
        "video.codec": "h264",
        "video.pix_fmt": "yuv420p",
        "video.is_depth_map": False,
        "video.fps": hz,
        "video.channels": 3,
        "has_audio": False,
    }


def video_bytes(images: Sequence[Image], hz: int) -> bytes:
    """Return an MP4 file with these images."""
    # The encoder's module needs half a second.
    from symolo.video.encoders import Film, mp4_chunks  # noqa: PLC0415

    film = Film(len(images), Fraction(hz), lambda index: images[index].pixels())
    return b"".join(mp4_chunks(film, key_frame_every=_KEY_FRAME_EVERY))
