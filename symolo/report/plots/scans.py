"""Plot of what a lidar met: the points of some scans over the arena, from above."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from symolo.arena.geometry import Arena
from symolo.pages.plotting import BLACK, svg
from symolo.reader.run import Run
from symolo.reader.scans import scan_points
from symolo.report.statistics.run_facts import fresh

MAX_SCANS = 12
_SIZE_IN = 6.0
_WALL, _TAPE = "#C9C9C9", "#E4E4E4"


def scan_plot(run: Run, lidar: str) -> bytes:
    """Return the plot as SVG; obstacles that move are where they are at the start.

    Raises:
        InputError: The table is missing or damaged.
    """
    run = fresh(run)
    sensor, arena = run.sensors[lidar], Arena.from_config(run.spec.arena)
    chosen = np.unique(np.linspace(0, len(sensor.t_s) - 1, MAX_SCANS).round().astype(int))
    points = scan_points(run, sensor)[chosen]
    t_s = np.repeat(sensor.t_s[chosen], points.shape[1])
    points = points.reshape(-1, 3)
    seen = np.isfinite(points).all(axis=1)
    figure = Figure(figsize=(_SIZE_IN, _SIZE_IN), layout="constrained")
    axes = figure.subplots()
    for left, right in arena.line.edges():
        axes.add_patch(Polygon(np.concatenate((left, right[::-1])), facecolor=_TAPE, edgecolor="none"))
    for box in arena.boxes:
        axes.add_patch(Polygon(box.footprint(), facecolor=_WALL, edgecolor=BLACK, linewidth=0.5))
    axes.plot(run.table.pose[:, 0], run.table.pose[:, 1], color=BLACK, linewidth=0.8)
    dots = axes.scatter(points[seen, 0], points[seen, 1], c=t_s[seen], s=3, cmap="viridis", zorder=3, rasterized=True)
    figure.colorbar(dots, ax=axes, shrink=0.6, label="time since the start of the run [s]")
    axes.set(aspect="equal", xlabel="x [m]", ylabel="y [m]")
    axes.grid(alpha=0.25)
    axes.set_axisbelow(True)
    return svg(figure)
