"""The page of a release that is being made, which the browser loads again every few seconds."""

import time
from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np

from pipeline.release_view.snapshot import RenderedImage, RunProgress, Snapshot
from pipeline.run_folder.shown_runs import shown_runs
from symolo.core.errors import InputError
from symolo.core.progress import plural, seconds
from symolo.dataset.layout import STAGES
from symolo.pages.html import render_page
from symolo.pages.states import NO_STATE, named
from symolo.pages.thumbnails import thumbnail
from symolo.playback.from_run import playback_of
from symolo.reader.run import Run
from symolo.video.floor import FloorView

_FLOOR_PX = 420
_STRIP = 6
"""Images before the last one that are shown."""


@dataclass(frozen=True)
class LastMoment:
    """The last image with its place."""

    image: bytes
    """Image as JPEG."""
    floor: bytes
    """PNG of the floor from above."""
    caption: str
    earlier: tuple[tuple[bytes, str], ...]
    """JPEG and caption of the images before it, the last one first."""


def release_page(name: str, progress: Snapshot, every_s: float) -> bytes:
    """Return the page.

    Args:
        name: Name of the output folder.
        progress: How far the release is.
        every_s: Time after which a browser loads the page again; it does not if the release is finished.
    """
    newest = progress.newest
    page = render_page(
        "pipeline.release_view",
        title=f"{name}: {_headline(progress)}",
        name=name,
        headline=_headline(progress),
        progress=progress,
        share=progress.rendered / progress.planned if progress.planned else 0.0,
        left="" if progress.left_s is None else f"about {seconds(progress.left_s)} left",
        moment=None if newest is None else _moment(progress, newest),
        every_s=0 if progress.finished else max(1, round(every_s)),
        updated=time.strftime("%H:%M:%S", time.localtime(progress.taken_s)),
    )
    return page.encode()


def _headline(progress: Snapshot) -> str:
    if progress.finished:
        return f"finished, {plural(len(progress.runs), 'run')} and {plural(progress.rendered, 'image')}"
    if not progress.runs:
        return "the first run is being simulated" if progress.working else "no run is simulated"
    if not progress.working:
        return f"stopped after {progress.rendered} of {plural(progress.planned, 'image')}"
    if progress.planned and progress.rendered == progress.planned:
        return "all images are rendered, the dataset is being assembled"
    return f"{progress.rendered} of {plural(progress.planned, 'image')}"


def _moment(progress: Snapshot, newest: RenderedImage) -> LastMoment | None:
    """Return the last image with its place; None if its run is being made again at this moment."""
    try:
        return _moment_of(progress, newest)
    except InputError:
        return None


def _moment_of(progress: Snapshot, newest: RenderedImage) -> LastMoment:
    (its_run,) = (run for run in progress.runs if run.run == newest.run)
    folder = next(above for above in newest.path.parents if above.name == STAGES) / "simulate" / newest.run
    with shown_runs(folder) as data:
        run = data.runs[0]
        image = run.image(newest.number)
        playback = playback_of(run)
        floor = FloorView(playback, _FLOOR_PX, _FLOOR_PX).frame(image.row).pixels
        state = int(playback.state[image.row])
        caption = f"{newest.run}, image {newest.number} of {its_run.planned}, {image.t_s:.1f} s"
        caption += f", state {named(state)}" if state != NO_STATE else ""
        encoded = cv2.imencode(".png", np.ascontiguousarray(floor[..., ::-1]))[1].tobytes()
        earlier = tuple(_earlier(run, its_run, newest))
        return LastMoment(thumbnail(image, 640), encoded, caption, earlier)


def _earlier(run: Run, progress: RunProgress, newest: RenderedImage) -> Iterator[tuple[bytes, str]]:
    before = sorted((image for image in progress.images if image != newest), key=lambda image: -image.made_s)
    for image in before[:_STRIP]:
        yield thumbnail(run.image(image.number)), f"image {image.number}"
