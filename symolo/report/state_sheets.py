"""Which images are shown for each state (the paper's Fig. 28), and their copies for the page."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from symolo.core.errors import InputError
from symolo.core.files.plain_files import FileKind, read_file
from symolo.reader.dataset import Dataset
from symolo.report.statistics.run_facts import RunFacts
from symolo.report.statistics.spread import spread

MAX_IMAGES = 6
"""Images of each state."""
_MAX_WIDTH_PX = 320
_QUALITY = 85


@dataclass(frozen=True)
class StateImage:
    """An image by its run and number, and the time [s] at which it was taken."""

    run: str
    number: int
    t_s: float


def images_of_states(facts: Sequence[RunFacts]) -> Mapping[int, tuple[StateImage, ...]]:
    """Return at most `MAX_IMAGES` images of each state, from as many runs as possible, by the number of the state."""
    by_state: dict[int, dict[str, list[StateImage]]] = {}
    for run in facts:
        for number, state, t_s in run.images:
            by_run = by_state.setdefault(state, {})
            by_run.setdefault(run.record.run, []).append(StateImage(run.record.run, number, t_s))
    return {state: _choose(list(by_state[state].values())) for state in sorted(by_state)}


def _choose(images_by_run: Sequence[Sequence[StateImage]]) -> tuple[StateImage, ...]:
    """Return about as many images from each run, each run at other parts of its time."""
    runs = spread(images_by_run, MAX_IMAGES)
    chosen: dict[StateImage, None] = {}  # a run with few images would be shown twice
    for i, images in enumerate(runs):
        count = (i + 1) * MAX_IMAGES // len(runs) - i * MAX_IMAGES // len(runs)
        for k in range(count):
            # Runs are offset against each other, so that together they cover the time evenly.
            share = (k + (i + 0.5) / len(runs)) / count
            chosen[images[int(share * len(images))]] = None
    return tuple(chosen)


def thumbnail(data: Dataset, run: str, number: int) -> bytes:
    """Return an image as JPEG, scaled down if it is wider than the page needs.

    Raises:
        InputError: It is missing or cannot be decoded.
    """
    import cv2  # noqa: PLC0415 - takes half a second, which readers of tables need not wait for

    image = data[run].image(number)
    pixels = image.pixels()
    height_px, width_px = pixels.shape[:2]
    if width_px <= _MAX_WIDTH_PX:
        return read_file(image.path, FileKind.IMAGE)
    size = (_MAX_WIDTH_PX, max(1, round(height_px * _MAX_WIDTH_PX / width_px)))
    small = np.asarray(cv2.resize(pixels, size, interpolation=cv2.INTER_AREA), np.uint8)
    encoded, jpeg = cv2.imencode(".jpg", small[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])
    if not encoded:
        raise InputError("cannot be scaled down", where=str(image.path))
    return jpeg.tobytes()
