"""Frames as a file: MP4 with H.264, animated GIF, animated WebP. The same frames give the same bytes."""

import io
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain
from pathlib import Path

import numpy as np
from PIL import Image

from symolo.core.extras import optional_module
from symolo.core.files.plain_files import open_file
from symolo.core.files.scratch_folders import scratch_folder
from symolo.pages.plotting import COLOURS
from symolo.video.canvas import Pixels, rgb

_CHUNK_BYTES = 1 << 20
_PALETTE_FRAMES = 12
"""Frames from which the 256 colours of a GIF are chosen."""
_WEIGHT = 12
"""Rows of pixels in the choice of the colours, for each colour of a curve."""
_BT709 = "colorprim=bt709:transfer=bt709:colormatrix=bt709"
"""The colours that players assume for high definition, stated in the file."""


@dataclass(frozen=True)
class Film:
    """The frames of a video, each made when it is needed."""

    count: int
    """Number of frames, at least one."""
    fps: Fraction
    frame: Callable[[int], Pixels]
    """Function that returns a frame (H, W, 3) in red, green, blue by its index; all have the same even size."""

    def frames(self) -> Iterator[Pixels]:
        return map(self.frame, range(self.count))


def mp4_chunks(film: Film, *, key_frame_every: int | None = None) -> Iterator[bytes]:
    """Yield an MP4 file with H.264, whose index comes first so that it plays while it loads.

    Args:
        film: The frames.
        key_frame_every: Largest distance of frames that can be decoded without others; None for the usual distance.

    Raises:
        EnvironmentLacking: The extra `video` is not installed.
    """
    av = optional_module("av")
    frames = film.frames()
    first = next(frames)
    height_px, width_px = first.shape[:2]
    with scratch_folder() as folder:
        path = folder / "video.mp4"
        with av.open(str(path), "w", format="mp4", options={"movflags": "faststart"}) as container:
            # One thread, because the bytes depend on their number.
            options = {"crf": "20", "preset": "medium", "threads": "1", "x264-params": _BT709}
            options |= {"g": str(key_frame_every)} if key_frame_every else {}
            stream = container.add_stream("libx264", rate=film.fps, options=options)
            stream.width, stream.height, stream.pix_fmt = width_px, height_px, "yuv420p"
            for pixels in chain((first,), frames):
                frame = av.VideoFrame.from_ndarray(pixels, format="rgb24")
                container.mux(stream.encode(frame.reformat(format="yuv420p", dst_colorspace="ITU709")))
            container.mux(stream.encode())
        with open_file(path) as file:
            while chunk := file.read(_CHUNK_BYTES):
                yield chunk


def gif_chunks(film: Film) -> Iterator[bytes]:
    """Yield an animated GIF that repeats; all frames share 256 colours, so that nothing flickers."""
    chosen = np.unique(np.linspace(0, film.count - 1, _PALETTE_FRAMES).round().astype(int))
    samples = [film.frame(int(index))[::2, ::2] for index in chosen]
    # The few pixels of a curve would not get a colour of their own.
    curve_colors = np.repeat(np.array([rgb(code) for code in COLOURS], np.uint8), _WEIGHT, axis=0)
    width_px = samples[0].shape[1]
    strips = np.repeat(curve_colors[:, None], width_px, axis=1)
    mosaic = np.concatenate([*samples, strips])
    palette = Image.fromarray(mosaic).quantize(256, method=Image.Quantize.MEDIANCUT)

    def reduced(pixels: Pixels) -> Image.Image:
        return Image.fromarray(pixels).quantize(palette=palette, dither=Image.Dither.NONE)

    yield _animation("GIF", map(reduced, film.frames()), _durations_ms(film, 10), optimize=False)


def webp_chunks(film: Film) -> Iterator[bytes]:
    """Yield an animated WebP that repeats."""
    yield _animation("WEBP", map(Image.fromarray, film.frames()), _durations_ms(film, 1), quality=75, method=4)


def _animation(kind: str, pictures: Iterable[Image.Image], durations_ms: list[int], **options: object) -> bytes:
    buffer, frames = io.BytesIO(), iter(pictures)
    next(frames).save(
        buffer, format=kind, save_all=True, append_images=frames, duration=durations_ms, loop=0, **options
    )
    return buffer.getvalue()


def _durations_ms(film: Film, unit_ms: int) -> list[int]:
    """Return how long each frame is shown, in whole units, so that the times do not drift."""
    ends = [round(1000 * (k + 1) / film.fps / unit_ms) * unit_ms for k in range(film.count)]
    return np.diff([0, *ends]).tolist()


@dataclass(frozen=True)
class VideoFormat:
    """A file format of videos."""

    chunks: Callable[[Film], Iterator[bytes]]
    """Function that encodes a film."""
    width_px: int
    fps: int
    """Usual width and rate."""
    max_frames: int
    """Largest number of frames; an encoder may hold all of them in memory."""


FORMATS: Mapping[str, VideoFormat] = {
    ".mp4": VideoFormat(mp4_chunks, width_px=1280, fps=20, max_frames=200_000),
    ".gif": VideoFormat(gif_chunks, width_px=640, fps=10, max_frames=1500),
    ".webp": VideoFormat(webp_chunks, width_px=640, fps=10, max_frames=5000),
}
"""Formats by the ending of the file."""


def check_encoder(path: Path) -> None:
    """Check, before frames are drawn, that the encoder of a file is installed.

    Raises:
        EnvironmentLacking: It is not.
    """
    if path.suffix == ".mp4":
        optional_module("av")
