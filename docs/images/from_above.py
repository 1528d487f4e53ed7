"""An arena and a run in it, drawn from above."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

import symolo
from symolo.arena.geometry import Arena

ROBOT_M = (0.20, 0.17)
"""Length and width at which the robot is drawn from above."""
RANGES = {"d_f": "front", "d_l": "left", "d_r": "right"}
"""Columns of data.csv, with the name of the sensor."""
NO_TARGET_M = 1.3
"""A range beyond this one is not drawn."""
COLOURS = {0: "#1f77b4", 1: "#2ca02c", 2: "#2ca02c", 3: "#9467bd", 4: "#9467bd", 5: "#ff7f0e", 6: "#ff7f0e"}
STATES = {0: "follows the line", 1: "follows a wall", 2: "follows a wall", 3: "turns", 4: "turns"}


def run_from_above(arena: Arena, run: symolo.Run, row: int) -> Image.Image:
    """Return an image of the floor with the path and the ranges of a run until a row of data.csv."""
    figure = Figure(figsize=(2.4, 2.4), dpi=100)
    axes = figure.add_axes((0.0, 0.0, 1.0, 0.92))
    draw_arena(axes, arena)
    rows = run.rows.iloc[: row + 1]
    axes.plot(rows["x"], rows["y"], color="#1f77b4", linewidth=1.2)
    here = rows.iloc[-1]
    place, heading_rad = np.array([here["x"], here["y"]]), float(here["theta"])
    turn = np.array([[np.cos(heading_rad), np.sin(heading_rad)], [-np.sin(heading_rad), np.cos(heading_rad)]])
    for column, sensor in RANGES.items():
        if here[column] < NO_TARGET_M:
            mount = getattr(run.spec.robot.tof.mounts, sensor)
            along = np.array([np.cos(np.radians(mount.yaw_deg)), np.sin(np.radians(mount.yaw_deg))])
            beam = np.array([mount.x_m, mount.y_m]) + np.outer([0.0, here[column]], along)
            axes.plot(*(place + beam @ turn).T, color="#d62728", linewidth=0.9)
    state = int(here["state"])
    corners = 0.5 * np.array(ROBOT_M) * [[1, 1], [-1, 1], [-1, -1], [1, -1]]
    axes.fill(*(place + corners @ turn).T, facecolor=COLOURS.get(state, "#d62728"), edgecolor="black", linewidth=0.6)
    axes.set(xlim=(-1.05, 0.85), ylim=(-1.2, 1.05), aspect="equal")
    axes.axis("off")
    what = STATES.get(state, "avoids an obstacle" if state in {5, 6} else "searches the line")
    figure.text(0.03, 0.93, f"{run.t_s[row]:4.1f} s   {what}", fontsize=7)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")


def draw_arena(axes: Axes, arena: Arena) -> None:
    """Draw the line, the walls and the obstacles."""
    for left, right in arena.line.edges():
        axes.fill(*np.concatenate([left, right[::-1]]).T, color="black", linewidth=0.8)
    for box in arena.boxes:
        colour = "#8a8a8a" if box.kind == "wall" else "#c7a06a"
        axes.fill(*box.footprint().T, facecolor=colour, edgecolor="black", linewidth=0.4)
