"""Plots against time in a frame of a video, with a mark at the present."""

import numpy as np
from matplotlib.ticker import MaxNLocator

from symolo.core.arrays import Array
from symolo.dataset.tables.rows import NO_STATE
from symolo.pages.plotting import BLUE
from symolo.pages.states import STATE_STYLES, named, stretches
from symolo.playback.playback import CurvePlot, Playback, StripePlot
from symolo.video.canvas import Canvas, Colour, rgb, text_width
from symolo.video.rows import row_at

_FAINT, _GRID = (95, 100, 108), (220, 224, 228)
_MAX_TICKS = 3


class TimePlot:
    """One plot of a run; `draw` paints it with its mark onto a picture of its size."""

    def __init__(
        self, plot: CurvePlot | StripePlot, span_s: tuple[float, float], width_px: int, height_px: int, text_px: float
    ) -> None:
        self._plot, self._span_s, self._text_px = plot, span_s, text_px
        self._left, self._top = 3.4 * text_px, 1.5 * text_px
        self._right, self._bottom = width_px - 2.0, height_px - 1.4 * text_px
        self._still = Canvas.blank(width_px, height_px)
        title = f"{plot.title} [{plot.unit}]" if plot.unit else plot.title
        self._title_end = self._still.text(title, 0, text_px, text_px, _FAINT) + text_px
        if isinstance(plot, CurvePlot):
            self._curves(plot)
        else:
            self._stripes(plot)
        self._times()

    def draw(self, canvas: Canvas, t_s: float) -> None:
        """Paint the plot with the values and the mark of a time."""
        canvas.pixels[:] = self._still.pixels
        x = self._title_end
        if isinstance(self._plot, CurvePlot):
            row = row_at(self._plot.t_s, t_s)
            for curve in self._plot.curves:
                value = curve.values[row]
                number = "-" if np.isnan(value) else f"{value:.2f}"
                words = f"{curve.name} {number}" if len(self._plot.curves) > 1 else number
                canvas.text(words, x, self._text_px, self._text_px, rgb(curve.colour))
                # So that nothing moves from frame to frame.
                x += text_width(f"{curve.name} 0.00", self._text_px) + 0.7 * self._text_px
        mark = self._x(np.array([t_s, t_s]))
        canvas.line(np.column_stack((mark, [self._top, self._bottom])), rgb(BLUE), max(1.0, 0.09 * self._text_px))

    def _x(self, t_s: Array) -> Array:
        first, last = self._span_s
        return self._left + (self._right - self._left) * (t_s - first) / max(last - first, 1e-9)

    def _times(self) -> None:
        """Write round times below the plot, the last one with its unit."""
        size_px = 0.85 * self._text_px
        first_s, last_s = self._span_s
        times_s = [t_s for t_s in ticks_around(np.array(self._span_s), from_zero=False) if first_s <= t_s <= last_s]
        for t_s in times_s:
            words = f"{t_s:g} s" if t_s == times_s[-1] else f"{t_s:g}"
            width = text_width(words, size_px)
            x = min(float(self._x(np.array(t_s))) - 0.5 * width, self._right - width)
            self._still.text(words, x, self._bottom + 1.2 * size_px, size_px, _FAINT)

    def _curves(self, plot: CurvePlot) -> None:
        ticks = ticks_around(np.concatenate([curve.values for curve in plot.curves]), from_zero=plot.from_zero)
        low, high = ticks[0], ticks[-1]

        def y(values: Array) -> Array:
            return self._bottom - (self._bottom - self._top) * (values - low) / (high - low)

        for tick in ticks:
            at = float(y(np.array(tick)))
            self._still.line(np.array([[self._left, at], [self._right, at]]), _GRID, 1.0)
            self._label(f"{tick:g}", at + 0.35 * self._text_px)
        for curve in plot.curves:
            points = np.column_stack((self._x(plot.t_s), y(curve.values)))
            for part in _without_gaps(points):
                self._still.line(part, rgb(curve.colour), max(1.0, 0.08 * self._text_px), curve.dash)

    def _stripes(self, plot: StripePlot) -> None:
        rows = np.searchsorted(plot.t_s, np.linspace(*self._span_s, round(self._right - self._left)), side="right") - 1
        levels = np.clip(255 * np.nan_to_num(plot.levels), 0, 255)[np.maximum(rows, 0)].T[::-1]
        place = self._still.pixels[round(self._top) : round(self._bottom), round(self._left) : round(self._right)]
        which = np.linspace(0, len(levels) - 1e-6, place.shape[0], endpoint=False).astype(int)
        place[:] = np.rint(levels[which][:, : place.shape[1], None])
        self._label(plot.names[-1], self._top + 0.9 * self._text_px)
        self._label(plot.names[0], self._bottom)

    def _label(self, words: str, y: float) -> None:
        size_px = 0.85 * self._text_px
        self._still.text(words, self._left - text_width(words, size_px) - 0.4 * self._text_px, y, size_px, _FAINT)


class StateBand:
    """The states of a run as coloured stretches."""

    def __init__(self, playback: Playback, width_px: int, height_px: int, text_px: float) -> None:
        self._run, self._text_px = playback, text_px
        self._still = Canvas.blank(width_px, height_px)
        self._top = 1.4 * text_px
        self._span_s = (float(playback.t_s[0]), float(playback.t_s[-1]))
        label = "state" if np.any(playback.state != NO_STATE) else "path"
        self._label_end = self._still.text(label, 0, text_px, text_px, _FAINT) + text_px
        for part in stretches(playback.state):
            left, right = self._x(playback.t_s[part.first]), self._x(playback.t_s[min(part.end, len(playback.t_s) - 1)])
            corners = np.array([[left, self._top], [right, self._top], [right, height_px], [left, height_px]])
            self._still.area(corners, rgb(STATE_STYLES[part.state].colour))

    def draw(self, canvas: Canvas, row: int) -> None:
        """Paint the band with the state and the mark of a row."""
        canvas.pixels[:] = self._still.pixels
        state = int(self._run.state[row])
        if state != NO_STATE:
            canvas.text(named(state), self._label_end, self._text_px, self._text_px, _dark(STATE_STYLES[state].colour))
        x = self._x(self._run.t_s[row])
        for colour, width in (((255, 255, 255), 0.4), (rgb(BLUE), 0.15)):
            points = np.array([[x, self._top], [x, canvas.pixels.shape[0]]])
            canvas.line(points, colour, max(1.0, width * self._text_px))

    def _x(self, t_s: float) -> float:
        first, last = self._span_s
        return (self._still.pixels.shape[1] - 1) * (t_s - first) / max(last - first, 1e-9)


def ticks_around(values: Array, *, from_zero: bool) -> list[float]:
    """Return round numbers, evenly spaced, that enclose the values; two or more."""
    known = values[np.isfinite(values)]
    low, high = (float(known.min()), float(known.max())) if len(known) else (0.0, 1.0)
    low = 0.0 if low > 0.0 and (from_zero or low < 0.5 * high) else low
    if high == low:  # a constant is shown together with 0
        low, high = (min(low, 0.0), max(high, 0.0)) if low else (0.0, 1.0)
    return list(map(float, MaxNLocator(nbins=_MAX_TICKS, steps=[1, 2, 5, 10]).tick_values(low, high)))


def _without_gaps(points: Array) -> list[Array]:
    """Return the runs of points that are numbers, of two points or more."""
    known = np.isfinite(points[:, 1])
    parts = np.split(points, np.flatnonzero(np.diff(known)) + 1)
    return [part for part in parts if len(part) > 1 and np.isfinite(part[0, 1])]


def _dark(code: str) -> Colour:
    """Return a colour that is dark enough for letters."""
    red, green, blue = (round(0.75 * part) for part in rgb(code))
    return red, green, blue
