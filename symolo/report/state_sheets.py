"""Which images show each state (the paper's Fig. 28), and how they are put into the page."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from symolo.core.errors import InputError
from symolo.reader.dataset import Dataset
from symolo.report.statistics.run_facts import RunFacts
from symolo.report.statistics.spread import spread

PER_STATE = 6
_WIDEST_PX = 320
_QUALITY = 85


@dataclass(frozen=True)
class Shown:
    run: str
    number: int
    t_s: float


def shown_of_states(facts: Sequence[RunFacts]) -> Mapping[int, tuple[Shown, ...]]:
    """Of each state in the order of their numbers at most `PER_STATE` images, from as many runs as can be."""
    of_state: dict[int, dict[str, list[Shown]]] = {}
    for one in facts:
        for number, state, t_s in one.images:
            by_run = of_state.setdefault(state, {})
            by_run.setdefault(one.record.run, []).append(Shown(one.record.run, number, t_s))
    return {state: tuple(_chosen(list(of_state[state].values()))) for state in sorted(of_state)}


def _chosen(of_runs: Sequence[Sequence[Shown]]) -> list[Shown]:
    """As many of each run as of any other, as far as they last, each run at other parts of its time."""
    runs = spread(of_runs, PER_STATE)
    found: dict[Shown, None] = {}
    for i, of_run in enumerate(runs):
        count = (i + 1) * PER_STATE // len(runs) - i * PER_STATE // len(runs)
        for k in range(count):
            share = (k + (i + 0.5) / len(runs)) / count
            found[of_run[int(share * len(of_run))]] = None
    return list(found)


def thumbnail(data: Dataset, run: str, number: int) -> bytes:
    """An image as JPEG: as it is, or smaller where it is wider than the page needs.

    Raises:
        InputError: It is missing or no picture.
    """
    import cv2  # noqa: PLC0415 - half a second that whoever reads tables does not need

    image = data[run].image(number)
    pixels = image.pixels()
    height_px, width_px = pixels.shape[:2]
    if width_px <= _WIDEST_PX:
        return image.path.read_bytes()
    size = (_WIDEST_PX, max(1, round(height_px * _WIDEST_PX / width_px)))
    small = np.asarray(cv2.resize(pixels, size, interpolation=cv2.INTER_AREA), np.uint8)
    encoded, jpeg = cv2.imencode(".jpg", small[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])
    if not encoded:
        raise InputError("cannot be made smaller", where=str(image.path))
    return jpeg.tobytes()
