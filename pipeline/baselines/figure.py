"""Paths over the map, and errors over time: a row of panels for each run."""

from itertools import cycle

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from matplotlib.ticker import LogFormatter

from pipeline.baselines.base import Estimator
from pipeline.baselines.compare import BaselineComparison
from pipeline.baselines.runs import TrueRun
from symolo.arena.geometry import Arena
from symolo.evaluation.errors import pose_errors
from symolo.pages.plotting import BLACK, BLUE, GREEN, GREY, ORANGE, PALE, PURPLE, SKY, VERMILION, finished, png

MAX_RUNS = 8
"""Number of runs in the figure; more would not fit on a page."""
STYLES = {
    "odometry": (VERMILION, "--"),
    "ekf": (BLUE, "-"),
    "particles": (GREEN, "-."),
    "retrieval": (ORANGE, ""),
    "learned": (ORANGE, "-"),
    "ekf_imu": (SKY, "-"),
    "lidar": (PURPLE, "-"),
    "stereo": (GREY, "-"),
}
"""Colour and line style of each method; an empty style stands for points."""
OTHER_STYLES = ((PURPLE, "--"), (ORANGE, "--"), (SKY, "-."), (GREY, "-."), (PURPLE, ":"), (BLUE, ":"), (GREEN, ":"))
"""Colours and line styles of other methods, in turn; none is black, as the truth is."""


class PlainNumbers(LogFormatter):
    """Labels of a logarithmic axis without powers of ten; between the powers only on short axes."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        return f"{x:g}" if super().__call__(x, pos) else ""


def figure(compared: BaselineComparison) -> bytes:
    """Return the figure of the first runs as PNG."""
    shown = compared.runs[:MAX_RUNS]
    drawn = Figure(figsize=(13.5, 4.0 * len(shown) + 0.3), layout="constrained")
    panels = drawn.subplots(len(shown), 3, width_ratios=(1.0, 1.15, 1.15), squeeze=False)
    for row, (run, (floor, place, turn)) in enumerate(zip(shown, panels, strict=True)):
        _map(floor, run.arena)
        floor.plot(*run.truth[:, :2].T, color=BLACK, linewidth=2.4, label="truth")
        floor.plot(*run.truth[0, :2], "o", color=BLACK, markersize=6)
        others = cycle(OTHER_STYLES)
        for method in compared.methods:
            _method(compared, run, method, STYLES.get(method.name) or next(others), (floor, place, turn))
        low, high = run.truth[:, :2].min(axis=0) - 0.3, run.truth[:, :2].max(axis=0) + 0.3
        floor.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
        for error in (place, turn):
            error.set_yscale("log")
            error.yaxis.set_major_formatter(PlainNumbers())
            error.yaxis.set_minor_formatter(PlainNumbers())
        place.set_ylim(bottom=0.3)
        turn.set_ylim(bottom=0.01)
        finished(floor, f"{run.name}, from the dot on", "x [m]", "y [m]", legend=False)
        finished(place, "Position error", "time [s]", "distance [mm]", legend=False)
        finished(turn, "Heading error", "time [s]", "angle [deg]", legend=False)
        if row == 0:
            handles, labels = floor.get_legend_handles_labels()
            drawn.legend(handles, labels, loc="outside upper center", ncols=len(labels), frameon=False)
    return png(drawn)


def _method(
    compared: BaselineComparison,
    run: TrueRun,
    method: Estimator,
    style: tuple[str, str],
    panels: tuple[Axes, Axes, Axes],
) -> None:
    floor, place, turn = panels
    colour, line = style
    estimate = compared.results[run.name, method.name].estimate
    t_s = run.t_s[estimate.rows]
    off_m, off_rad = pose_errors(estimate, run.truth)
    look = {
        "color": colour,
        "linewidth": 1.3,
        "linestyle": line or "none",
        "marker": "" if line else ".",
        "markersize": 3,
    }
    floor.plot(*estimate.pose[:, :2].T, label=method.title, **look)
    place.plot(t_s, np.maximum(1e3 * off_m, 1e-3), **look)
    turn.plot(t_s, np.maximum(np.degrees(off_rad), 1e-4), **look)


def _map(axes: Axes, arena: Arena) -> None:
    for left, right in arena.line.edges():
        axes.add_patch(Polygon(np.concatenate([left, right[::-1]]), facecolor=PALE, edgecolor="none"))
    for box in arena.boxes:
        moves = box.motion is not None
        axes.add_patch(Polygon(box.footprint(), facecolor="none" if moves else GREY, edgecolor=GREY))
