"""Plot of one run against time: states, speeds, ranges, line sensor, distance from the line."""

from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from symolo.arena.geometry import Arena
from symolo.core.arrays import Array
from symolo.dataset.tables.rows import RANGES, Rows
from symolo.pages.plotting import BLACK, BLUE, GREY, PALE, VERMILION, svg
from symolo.pages.states import STATE_STYLES, Stretch, named, stretches
from symolo.reader.run import Run
from symolo.report.statistics.off_line import ahead_of, off_line_m
from symolo.report.statistics.run_facts import RunFacts, fresh

Panel = Callable[[Axes], None]
"""Draws into a panel of the plot."""
_WIDTH_IN = 7.0
_CHANNELS = 8
_RANGES = (("front", BLACK, "-"), ("left", BLUE, (0, (4.0, 1.5))), ("right", VERMILION, (0, (1.0, 1.0))))


def run_plot(run: Run, facts: RunFacts) -> bytes:
    """Return the plot as SVG.

    Raises:
        InputError: A file of the run is missing or damaged.
    """
    run = fresh(run)
    rows = run.table
    parts = stretches(rows.state)
    t_s = rows.t_ms / 1000
    drawn = _panels(run, facts, t_s, parts)
    heights = [height for height, _ in drawn]
    figure = Figure(figsize=(_WIDTH_IN, sum(heights) + 1.1), layout="constrained")
    panels = figure.subplots(len(heights), 1, sharex=True, height_ratios=heights, squeeze=False)[:, 0]
    for axes, (_, draw) in zip(panels, drawn, strict=True):
        draw(axes)
    for axes in panels:
        for part in parts[1:]:
            axes.axvline(t_s[part.first], color=GREY, linewidth=0.5, linestyle=(0, (1.0, 2.0)), zorder=0)
    panels[0].set_xlim(_edges(t_s)[0], _edges(t_s)[-1])
    panels[-1].set_xlabel("time since the start of the run [s]")
    figure.align_ylabels(panels.tolist())
    return svg(figure)


def _panels(run: Run, facts: RunFacts, t_s: Array, parts: tuple[Stretch, ...]) -> list[tuple[float, Panel]]:
    """Return the height [in] and the drawing of each panel for which the run has data."""
    rows = run.table
    columns = set(rows.columns)
    panels: list[tuple[float, Panel]] = []
    if rows.has_state:
        height = 0.32 * len({part.state for part in parts}) + 0.25
        panels.append((height, lambda axes: _states(axes, t_s, parts)))
    speeds = (("v", rows.twist[:, 0], "v [m/s]"), ("w", rows.twist[:, 1], "w [rad/s]"))
    measured = [(values, label) for name, values, label in speeds if name in columns]
    if not measured:  # of an imported trajectory, the coordinates are what there is to see
        measured = list(zip(rows.pose.T, ("x [m]", "y [m]", "theta [rad]"), strict=True))
    panels += [
        (1.0, lambda axes, values=values, label=label: _curve(axes, t_s, values, label)) for values, label in measured
    ]
    if columns & {column.name for column in RANGES.columns}:
        panels.append((1.5, lambda axes: _ranges(axes, t_s, rows, facts)))
    if "L0" in columns:
        panels.append((1.1, lambda axes: _line(axes, t_s, rows.line)))
    if facts.arena.line.pieces or not run.spec.is_imported:
        panels.append((1.5, lambda axes: _off_line(axes, rows, facts.arena, run.spec.robot.line_sensor.x_m)))
    return panels


def _curve(axes: Axes, t_s: Array, values: Array, label: str) -> None:
    axes.axhline(0.0, color=GREY, linewidth=0.6)
    axes.plot(t_s, values, color=BLACK, linewidth=0.9)
    axes.set_ylabel(label)


def _states(axes: Axes, t_s: Array, parts: tuple[Stretch, ...]) -> None:
    present = sorted({part.state for part in parts})
    edges = _edges(t_s)
    for part in parts:
        from_s, to_s = edges[part.first], edges[part.end]
        axes.barh(present.index(part.state), to_s - from_s, 0.7, left=from_s, color=STATE_STYLES[part.state].colour)
    axes.set_yticks(range(len(present)), [named(state) for state in present], fontsize="small")
    axes.set_ylim(len(present) - 0.4, -0.6)
    axes.set_ylabel("state")


def _ranges(axes: Axes, t_s: Array, rows: Rows, facts: RunFacts) -> None:
    """Draw the ranges, with gaps where a sensor saw no target."""
    no_target_m = facts.record.tof_no_target_m
    for (name, colour, dash), values in zip(_RANGES, rows.tof_m.T, strict=True):
        seen = np.where(values == no_target_m, np.nan, values)
        axes.plot(t_s, seen, color=colour, linestyle=dash, linewidth=1.1, label=name)
    hits_m = rows.tof_m[(rows.tof_m != no_target_m) & np.isfinite(rows.tof_m)]
    longest_m = facts.record.tof_max_range_m or 1.0
    farthest_m = float(hits_m.max()) if hits_m.size else longest_m
    axes.set_ylim(0.0, 1.05 * min(longest_m, farthest_m))
    if not hits_m.size:
        axes.text(0.5, 0.5, "no sensor saw a target", transform=axes.transAxes, ha="center", va="center")
    axes.set_ylabel("range [m]")
    axes.grid(alpha=0.3)
    axes.legend(loc="best", ncols=3, fontsize="small", framealpha=0.7)


def _line(axes: Axes, t_s: Array, line: Array) -> None:
    """Draw the readings as a strip of greys, L7 (left end of the row) on top."""
    channels = np.arange(_CHANNELS + 1) - 0.5
    axes.pcolormesh(_edges(t_s), channels, line.T, cmap="gray", vmin=0.0, vmax=1.0, rasterized=True)
    axes.set_yticks([0, 7], ["L0 right", "L7 left"], fontsize="small")
    axes.set_ylabel("line sensor")


def _off_line(axes: Axes, rows: Rows, arena: Arena, ahead_m: float) -> None:
    """Draw the distance from the line; the axis is linear up to 1 mm and logarithmic above."""
    axes.set_ylabel("off the line [mm]")
    if not arena.line.pieces:
        axes.text(0.5, 0.5, "there is no line", transform=axes.transAxes, ha="center", va="center")
        return
    t_s, off_mm = rows.t_ms / 1000, 1000.0 * off_line_m(arena.line, ahead_of(rows.pose, ahead_m))
    for part in stretches(rows.state):
        inside = slice(part.first, part.end + 1)
        axes.plot(t_s[inside], off_mm[inside], color=STATE_STYLES[part.state].colour, linewidth=1.1)
    axes.axhspan(0.0, 500.0 * arena.line.width_m, color=PALE, alpha=0.6, linewidth=0.0, zorder=0)
    farthest = int(np.argmax(off_mm))
    axes.plot(t_s[farthest], off_mm[farthest], "v", color=BLACK, markersize=5)
    axes.set_yscale("symlog", linthresh=1.0)
    axes.set_ylim(0.0, max(20.0, 2.2 * float(off_mm.max())))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.grid(alpha=0.3)


def _edges(t_s: Array) -> Array:
    """Return the times (N + 1,) at which each row begins and ends: half way between rows."""
    if len(t_s) == 1:
        return np.array([t_s[0] - 0.5, t_s[0] + 0.5])
    middles = 0.5 * (t_s[:-1] + t_s[1:])
    return np.concatenate(([2 * t_s[0] - middles[0]], middles, [2 * t_s[-1] - middles[-1]]))
