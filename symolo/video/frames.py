"""Frames of a video of one run: what the camera sees, the floor from above, the state and the readings."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate
from math import ceil, floor, sqrt

import numpy as np

from symolo.core.arrays import Array
from symolo.playback.playback import CameraTrack, CurvePlot, Playback, StripePlot
from symolo.video.canvas import Canvas, Pixels, text_width
from symolo.video.floor import FloorView
from symolo.video.rows import row_at
from symolo.video.time_plots import StateBand, TimePlot

_BASE_WIDTH_PX = 1280
_TEXT_PX = 15.0
"""Height of letters at this width; of narrower videos, a little less."""
_MIN_TEXT_PX = 10.0
_PLOTS = 3
"""Plots below the pictures."""
_GREY = (236, 238, 240)


def times_s(rows_s: Array, fps: float, speed: float) -> list[float]:
    """Return the time of each frame of a run, that of the first and the last row among them.

    Args:
        rows_s: (N,), times of the rows.
        fps: Frames of the video per second.
        speed: Seconds of the run per second of the video.
    """
    first, last = float(rows_s[0]), float(rows_s[-1])
    count = floor((last - first) * fps / speed + 1e-6)
    times = [first + k * speed / fps for k in range(count + 1)]
    return times if times[-1] > last - 1e-6 else [*times, last]


@dataclass(frozen=True)
class Place:
    """A part of the frame [px]."""

    x: int
    y: int
    width: int
    height: int

    @property
    def end_y(self) -> int:
        return self.y + self.height

    def cut_from(self, canvas: Canvas) -> Canvas:
        """Return this part of a picture."""
        return canvas.part(self.x, self.y, self.width, self.height)


class RunFrames:
    """The frames of one run, of one size."""

    def __init__(self, playback: Playback, title: str, width_px: int, height_px: int) -> None:
        """Lay out the frame and draw what is the same in every frame.

        Args:
            playback: The run.
            title: Text at the top.
            width_px: Width of the frames.
            height_px: Height of the frames.
        """
        self._run, self._title = playback, title
        self._text_px = max(_MIN_TEXT_PX, _TEXT_PX * width_px / _BASE_WIDTH_PX)
        self._blank = Canvas.blank(width_px, height_px)
        gap, inner = round(0.8 * self._text_px), width_px - 2 * round(0.8 * self._text_px)
        half = (inner - gap) // 2
        self._header = Place(gap, gap, inner, round(1.6 * self._text_px))
        band_px, top = round(2.4 * self._text_px), self._header.end_y + gap // 3
        if playback.cameras:
            plots = Place(gap, height_px - gap - round(7.2 * self._text_px), inner, round(7.2 * self._text_px))
            band = Place(gap, plots.y - gap - band_px, inner, band_px)
            pictures = Place(gap, top, half, band.y - gap - top)
            self._floor_at = Place(gap + half + gap, top, inner - half - gap, pictures.height)
            # Wider ones for more curves, which have a longer legend.
            weights = [
                1.0 + 0.3 * (len(plot.curves) - 1) for plot in _chosen(playback)[:_PLOTS] if isinstance(plot, CurvePlot)
            ]
            plot_places = _side_by_side(plots, [*weights, *[1.0] * _PLOTS][:_PLOTS], gap)
        else:
            band = Place(gap, height_px - gap - band_px, inner, band_px)
            pictures = Place(gap, top, 0, band.y - gap - top)
            self._floor_at = Place(gap, top, half, pictures.height)
            plots = Place(gap + half + gap, top, inner - half - gap, pictures.height)
            plot_places = _below_each_other(plots, _PLOTS + 1, gap)
        self._band_at, self._band = band, StateBand(playback, band.width, band.height, self._text_px)
        self._cameras = [
            (place, _CameraPicture(camera, self._text_px if len(playback.cameras) > 1 else None))
            for camera, place in zip(playback.cameras, _grid(pictures, len(playback.cameras), gap), strict=True)
        ]
        self._floor = FloorView(playback, self._floor_at.width, self._floor_at.height)
        self._plots = [
            (place, self._plot(plot, place)) for plot, place in zip(_chosen(playback), plot_places, strict=False)
        ]

    def _plot(self, plot: CurvePlot | StripePlot, place: Place) -> TimePlot:
        span_s = (float(self._run.t_s[0]), float(self._run.t_s[-1]))
        return TimePlot(plot, span_s, place.width, place.height, self._text_px)

    def at(self, t_s: float) -> Pixels:
        """Return the frame of a time, (H, W, 3), red, green, blue."""
        canvas, row = self._blank.copy(), row_at(self._run.t_s, t_s)
        self._write_header(self._header.cut_from(canvas), t_s)
        for place, camera in self._cameras:
            camera.draw(place.cut_from(canvas), t_s)
        self._floor_at.cut_from(canvas).pixels[:] = self._floor.frame(row).pixels
        self._band.draw(self._band_at.cut_from(canvas), row)
        for place, plot in self._plots:
            plot.draw(place.cut_from(canvas), t_s)
        return canvas.pixels

    def _write_header(self, canvas: Canvas, t_s: float) -> None:
        size_px = 1.25 * self._text_px
        clock, width_px = f"{t_s:.1f} s", canvas.pixels.shape[1]
        clock_px = text_width(clock, size_px)
        free_px = width_px - clock_px - 2 * size_px
        title_px = size_px * min(1.0, free_px / max(text_width(self._title, size_px), 1.0))
        canvas.text(self._title, 0, size_px, title_px)
        canvas.text(clock, width_px - clock_px, size_px, size_px)


class _CameraPicture:
    """What one camera sees; the last picture stays in memory, because several frames show it."""

    def __init__(self, camera: CameraTrack, name_px: float | None) -> None:
        """Prepare the images; `name_px` is the height of the letters of the camera's name, None for no name."""
        self._camera, self._name_px = camera, name_px
        self._t_s = np.array([image.t_s for image in camera.images])
        self._shown, self._pixels = -1, np.empty((0, 0, 3), np.uint8)

    def draw(self, canvas: Canvas, t_s: float) -> None:
        index = row_at(self._t_s, t_s)
        if index != self._shown:
            canvas.pixels[:] = _GREY
            image = canvas.image(self._camera.images[index].pixels())
            if self._name_px is not None:
                self._write_name(image, self._name_px)
            self._shown, self._pixels = index, canvas.pixels.copy()
        canvas.pixels[:] = self._pixels

    def _write_name(self, image: Canvas, size_px: float) -> None:
        """Write the name in the upper left corner, on a white ground that is legible on any image."""
        margin = 0.4 * size_px
        width, height = text_width(self._camera.name, size_px) + 2 * margin, 1.6 * size_px
        image.part(0, 0, round(width), round(height)).pixels[:] = 255
        image.text(self._camera.name, margin, 1.15 * size_px, size_px)


def _chosen(playback: Playback) -> list[CurvePlot | StripePlot]:
    """Return the plots of a run, curves first."""
    curves = [plot for plot in playback.plots if isinstance(plot, CurvePlot)]
    return [*curves[:_PLOTS], *(plot for plot in playback.plots if not isinstance(plot, CurvePlot)), *curves[_PLOTS:]]


def _side_by_side(place: Place, weights: Sequence[float], gap: int) -> list[Place]:
    """Return places whose widths are as these weights."""
    free = place.width - gap * (len(weights) - 1)
    ends = [round(free * share / sum(weights)) for share in accumulate(weights)]
    starts = [0, *ends[:-1]]
    return [
        Place(place.x + start + k * gap, place.y, end - start, place.height)
        for k, (start, end) in enumerate(zip(starts, ends, strict=True))
    ]


def _below_each_other(place: Place, count: int, gap: int) -> list[Place]:
    height = (place.height - gap * (count - 1)) // count
    return [Place(place.x, place.y + k * (height + gap), place.width, height) for k in range(count)]


def _grid(place: Place, count: int, gap: int) -> list[Place]:
    """Return places for pictures, in about as many rows as columns."""
    columns = ceil(sqrt(count))
    rows = _below_each_other(place, ceil(count / columns), gap) if count else []
    return [one for row in rows for one in _side_by_side(row, [1.0] * columns, gap)][:count]
