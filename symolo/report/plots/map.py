"""Plot of the floor from above: line, walls, obstacles, and the paths of all runs in the colours of their states."""

from collections.abc import Iterable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Polygon
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MultipleLocator

from symolo.arena.geometry import Box
from symolo.core.arrays import Array
from symolo.dataset.tables.rows import NO_STATE
from symolo.pages.plotting import BLACK, GREY, svg
from symolo.pages.states import STATE_STYLES, named, stretches
from symolo.report.plots.labels import FONT_PT, Label, placed_labels
from symolo.report.statistics.maps import RouteMap
from symolo.report.statistics.run_facts import RunPath

_WALL, _OBSTACLE, _TAPE = "#8A8A8A", "#F4F4F4", "#C9C9C9"
_MARGIN = 0.06
"""Free margin around the arena, as a share of its longer side."""
_WIDTH_IN, _HIGHEST_IN = 6.0, 7.0
_LABELS_IN, _TITLE_IN, _LEGEND_ROW_IN = 0.75, 0.9, 0.19
"""Space for the labels beside the panel, for title and labels above and below it, and for a row of the legend."""
_LEGEND_COLUMNS = 3
_POINTS_PER_IN = 72.0
_ARROW_PT = 26.0
_MARKED_M = 0.05
"""Radius around the start in which no number would be readable."""
_GHOSTS = 4
"""Number of later places at which a moving obstacle is drawn."""
_HALO = [withStroke(linewidth=2.5, foreground="white")]


def map_plot(one: RouteMap) -> bytes:
    """Return the map as SVG."""
    return svg(map_figure(one))


def map_figure(one: RouteMap) -> Figure:
    """Return the map."""
    low, high = _corners(one)
    width_m, height_m = (high - low).tolist()
    floor_in = (_WIDTH_IN - _LABELS_IN) / width_m * height_m
    handles = _legend(one)
    around_in = _TITLE_IN + _LEGEND_ROW_IN * -(-len(handles) // _LEGEND_COLUMNS)
    figure = Figure(figsize=(_WIDTH_IN, min(floor_in, _HIGHEST_IN) + around_in), layout="constrained")
    _panel(figure.subplots(), one)
    figure.legend(handles=handles, loc="outside lower center", ncols=_LEGEND_COLUMNS, fontsize="small", frameon=False)
    return figure


def _scale(low: Array, high: Array) -> float:
    """Return about how many points a metre takes on the map."""
    width_m, height_m = (high - low).tolist()
    return _POINTS_PER_IN * min((_WIDTH_IN - _LABELS_IN) / width_m, _HIGHEST_IN / height_m)


def _corners(one: RouteMap) -> tuple[Array, Array]:
    arena = one.arena
    points = [edge for pair in arena.line.edges() for edge in pair]
    points += [place for box in arena.boxes for place in footprints(box, _times(one.duration_s))]
    points += [facts.path.pose[:, :2] for facts in one.runs if facts.path is not None]
    everything = np.concatenate(points)
    low, high = everything.min(axis=0), everything.max(axis=0)
    free_m = _MARGIN * max(float((high - low).max()), 0.1)
    return low - free_m, high + free_m


def _panel(axes: Axes, one: RouteMap) -> None:
    low, high = _corners(one)
    for left, right in one.arena.line.edges():
        axes.add_patch(Polygon(np.concatenate((left, right[::-1])), facecolor=_TAPE, edgecolor="none", zorder=1))
    for box in one.arena.boxes:
        _box(axes, box, one.duration_s)
    for label in placed_labels(one.arena.boxes, low, high, _scale(low, high)):
        _name(axes, label)
    for number, facts in enumerate(one.runs):
        if facts.path is not None:
            _path(axes, facts.path, numbered=number == 0)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal", xlabel="x [m]", ylabel="y [m]")
    step_m = next(step for step in (0.1, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 1e9) if float((high - low).max()) <= 10 * step)
    axes.xaxis.set_major_locator(MultipleLocator(step_m))
    axes.yaxis.set_major_locator(MultipleLocator(step_m))
    axes.set_anchor("N")
    axes.set_title(one.title, fontsize="medium")
    axes.grid(alpha=0.25)
    axes.set_axisbelow(True)


def _box(axes: Axes, box: Box, duration_s: float) -> None:
    face, hatch = (_WALL, None) if box.kind == "wall" else (_OBSTACLE, "////")
    corners = box.footprint()
    if box.motion is not None:
        route = box.poses_at(np.linspace(0.0, duration_s, 200))[:, :2]
        axes.plot(route[:, 0], route[:, 1], color=GREY, linewidth=1.0, linestyle=(0, (2.0, 2.0)), zorder=2)
        for ghost in footprints(box, _times(duration_s)[1:]):
            axes.add_patch(Polygon(ghost, facecolor="none", edgecolor=GREY, linewidth=0.6, zorder=2))
    axes.add_patch(Polygon(corners, facecolor=face, edgecolor=BLACK, linewidth=0.8, hatch=hatch, zorder=3))


def _name(axes: Axes, label: Label) -> None:
    axes.annotate(
        label.name,
        label.anchor_m,
        label.offset_pt,
        textcoords="offset points",
        rotation=label.turn_deg,
        rotation_mode="anchor",
        ha="center",
        va="center_baseline",
        fontsize=FONT_PT,
        zorder=7,
        path_effects=_HALO,
    )


def footprints(box: Box, t_s: Array) -> Iterable[Array]:
    """Yield the corners (4, 2) of a box at each of the times; only the first if it does not move."""
    first = np.array([*box.center[:2], box.yaw_rad])
    corners = box.footprint() - first[:2]
    for x, y, yaw in box.poses_at(t_s if box.motion is not None else t_s[:1]):
        turn = yaw - first[2]
        rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        yield np.asarray(corners @ rotation.T + (x, y), np.float64)


def _times(duration_s: float) -> Array:
    return np.linspace(0.0, duration_s, _GHOSTS + 1)


def _path(axes: Axes, path: RunPath, *, numbered: bool) -> None:
    pose = path.pose
    for part in stretches(path.state):
        style, rows = STATE_STYLES[part.state], slice(part.first, part.end + 1)
        axes.plot(pose[rows, 0], pose[rows, 1], color=style.colour, linestyle=style.dash, linewidth=1.4, zorder=4)
        x, y = pose[(part.first + part.end - 1) // 2, :2].tolist()
        if numbered and part.state != NO_STATE and np.hypot(x - pose[0, 0], y - pose[0, 1]) > _MARKED_M:
            ring = {"boxstyle": "circle,pad=0.15", "facecolor": "white", "edgecolor": style.colour, "linewidth": 0.9}
            axes.text(x, y, str(part.state), fontsize=6.5, ha="center", va="center", zorder=6, bbox=ring)
    x, y, theta = pose[0].tolist()
    axes.plot(x, y, "o", color=BLACK, markeredgecolor="white", markersize=8, zorder=5)
    if numbered:
        tip = (_ARROW_PT * np.cos(theta), _ARROW_PT * np.sin(theta))
        look = {"arrowstyle": "<|-,head_width=0.35,head_length=0.7", "color": BLACK, "linewidth": 2.2}
        look |= {"shrinkA": 0, "shrinkB": 0}
        axes.annotate("", (x, y), tip, textcoords="offset points", arrowprops=look, zorder=5)


def _legend(one: RouteMap) -> list[Line2D | Patch]:
    seen = {int(state) for facts in one.runs if facts.path is not None for state in np.unique(facts.path.state)}
    handles: list[Line2D | Patch] = []
    for state in sorted(seen):
        style = STATE_STYLES[state]
        handles.append(Line2D([], [], color=style.colour, linestyle=style.dash, label=named(state)))
    handles.append(Line2D([], [], color=BLACK, marker="o", linestyle="none", label="start pose"))
    if one.arena.line.pieces:
        handles.append(Patch(facecolor=_TAPE, label="line"))
    kinds = {box.kind for box in one.arena.boxes}
    if "wall" in kinds:
        handles.append(Patch(facecolor=_WALL, edgecolor=BLACK, label="wall"))
    if "obstacle" in kinds:
        handles.append(Patch(facecolor=_OBSTACLE, edgecolor=BLACK, hatch="////", label="obstacle, at the start"))
    if one.arena.moving:
        handles.append(Line2D([], [], color=GREY, linestyle=(0, (2.0, 2.0)), label="path of a moving obstacle"))
    return handles
