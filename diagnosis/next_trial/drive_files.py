"""The files of a designed drive: its path, set points for a board, and a controller and a scenario that drive it."""

from collections.abc import Iterator, Mapping
from math import ceil, degrees
from textwrap import fill

import numpy as np
import yaml
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from diagnosis.importers.drive_log import ROW_S
from diagnosis.next_trial.design import TrialDesign
from diagnosis.next_trial.library.drive_log import start_of, wheel_speeds
from diagnosis.next_trial.library.manoeuvres import path_of
from diagnosis.next_trial.template import nominal_drive
from symolo.core.arrays import Array
from symolo.pages.plotting import BLACK, BLUE, GREY, finished, png

PATH, FIGURE, SPEEDS, CONTROLLER, SCENARIO = "path.csv", "path.png", "wheel_speeds.h", "next_drive.py", "scenario.yaml"
PANELS, TITLE, WIDE = 4, 40, 3
"""Panels of the figure beside each other, letters in a line of their titles, and panels from which the legend has one
line."""
FLOOR_BEYOND_M = 1
"""Floor of the simulation beyond the walls."""
COMMANDS = ("v_cmd_m_s", "w_cmd_rad_s")


def drive_files(design: TrialDesign) -> Mapping[str, bytes]:
    """Return the contents by name; the same design gives the same bytes."""
    lines = {PATH: _path(design), SPEEDS: _speeds(design), CONTROLLER: _controller(design)}
    texts = {name: "\n".join(text) + "\n" for name, text in lines.items()}
    texts[SCENARIO] = _scenario(design)
    return {**{name: text.encode() for name, text in texts.items()}, FIGURE: _figure(design)}


def _commands(design: TrialDesign) -> Array:
    """Return the commands (N, 2) from each row to the next one."""
    (trial,) = design.trial.trials
    return np.stack([trial[name].values[:-1] for name in COMMANDS], axis=-1)


def planned_path(design: TrialDesign) -> Array:
    """Return the poses (N + 1, 3) of the planned path; the trial has them only if the old data have poses."""
    return path_of(_commands(design), start_of(design.limits))


def _path(design: TrialDesign) -> Iterator[str]:
    """Yield a table of the planned path with the commands from each row to the next one."""
    commands = _commands(design)
    columns = (commands, wheel_speeds(nominal_drive(design.trial), commands))
    held = np.concatenate([np.concatenate(columns, axis=1), np.zeros((1, 4))])
    rows = np.concatenate([design.trial.trials[0].t_s[:, None], held, planned_path(design)], axis=1)
    yield "t_s,v_cmd_m_s,w_cmd_rad_s,left_rad_s,right_rad_s,x_m,y_m,theta_rad,manoeuvre"
    for k, values in enumerate(rows.tolist()):
        number = min(int(k * len(design.titles) / len(commands)), len(design.titles) - 1) + 1
        # A sum with zero has no negative zero.
        yield ",".join([*(f"{round(value, 5) + 0.0:.5g}" for value in values), str(number)])


def _speeds(design: TrialDesign) -> Iterator[str]:
    """Yield a C header with the set points of both wheels."""
    speeds = np.rint(1000.0 * wheel_speeds(nominal_drive(design.trial), _commands(design))).astype(int)
    yield "/* Set points of the wheel speeds of the drive: each is held for a number of milliseconds. The wheels stand"
    yield "   still before the first and after the last one. */"
    yield "#ifndef WHEEL_SPEEDS_H"
    yield "#define WHEEL_SPEEDS_H"
    yield "#include <stdint.h>"
    yield "typedef struct { uint16_t milliseconds; int32_t right_mrad_s; int32_t left_mrad_s; } held_speeds;"
    yield "static const held_speeds DRIVE[] = {"
    yield from (f"  {{{1000.0 * ROW_S * rows:.0f}, {right}, {left}}}," for rows, (left, right) in _joined(speeds))
    yield "};"
    yield "#endif"


def _joined(values: Array) -> Iterator[tuple[int, tuple[float, float]]]:
    """Yield numbers of equal rows of values (N, 2) that follow each other, and their values."""
    starts = np.flatnonzero(np.any(np.diff(values, axis=0, prepend=np.nan) != 0.0, axis=1))
    for start, rows in zip(starts.tolist(), np.diff(starts, append=len(values)).tolist(), strict=True):
        first, second = values[start].tolist()
        yield rows, (first, second)


def _controller(design: TrialDesign) -> Iterator[str]:
    """Yield a controller for `--controller-file` that gives the commands of the drive."""
    yield '"""The drive of trial.md as a controller. It gives the commands and looks at nothing."""'
    yield ""
    yield "from physics.control.base import Observation, RobotController, Twist"
    yield ""
    yield "COMMANDS = ("
    yield from (f"    ({rows}, {v:g}, {w:g})," for rows, (v, w) in _joined(_commands(design)))
    yield ")"
    yield f'"""Number of ticks of {ROW_S:g} s, forward speed [m/s] and yaw rate [rad/s]."""'
    yield ""
    yield ""
    yield "class NextDrive(RobotController):"
    yield "    def start(self) -> None:"
    yield "        self.commands = [(v, w) for rows, v, w in COMMANDS for _ in range(rows)]"
    yield "        self.tick = 0"
    yield ""
    yield "    def step(self, seen: Observation) -> Twist:"
    yield "        v_m_s, w_rad_s = self.commands[self.tick] if self.tick < len(self.commands) else (0.0, 0.0)"
    yield "        self.tick += 1"
    yield "        return Twist(v_m_s, w_rad_s)"


def _scenario(design: TrialDesign) -> str:
    """Return a scenario in which the robot drives in the room of the old data, or on a floor without walls."""
    x_m, y_m, yaw_rad = planned_path(design)[0].tolist()
    start = {"x_m": round(x_m, 4), "y_m": round(y_m, 4), "yaw_deg": round(degrees(yaw_rad), 3)}
    scenario = {
        "extends": "smoke",
        "name": "next_drive",
        "description": "The drive that symolo next has designed",
        "routes": [{"name": "drive", "start": start, "runs": 1}],
        "stop": {"lap": False, "time_limit_s": float(design.trial.trials[0].t_s[-1])},
        "rates": {"control_hz": round(1.0 / ROW_S), "camera_hz": 0},
        "arena": _arena(design),
        "robot": "nominal",
    }
    return yaml.safe_dump(scenario, sort_keys=False)


def _arena(design: TrialDesign) -> Mapping[str, object]:
    """Return an arena without a line, whose walls are those of the room of the old data."""
    middle_m, half_m = np.array(design.limits.middle_m), 0.5 * np.array(design.limits.floor_m)
    corners_m = [middle_m - half_m, middle_m + half_m]
    walls: Mapping[str, object] = {}
    if (room := nominal_drive(design.trial).world) is not None:
        x_m, y_m = room.room_x_m, room.room_y_m
        corners_m += [np.array([x_m, y_m])]
        walls = {"polygons": [{"name": "room", "points": [[0.0, 0.0], [x_m, 0.0], [x_m, y_m], [0.0, y_m]]}]}
    return {
        "name": "next_drive",
        "floor": {"half_extent_m": ceil(float(np.abs(corners_m).max())) + FLOOR_BEYOND_M},
        "line": {"width_m": 0.015, "pieces": []},
        **walls,
    }


def _figure(design: TrialDesign) -> bytes:
    """Return the planned path from above, a panel for each manoeuvre, as PNG."""
    pose, commands = planned_path(design), _commands(design)
    rows = len(commands) // len(design.titles)
    middle_m, half_m = np.array(design.limits.middle_m), 0.5 * np.array(design.limits.floor_m)
    (left, bottom), (right, top) = (middle_m - half_m).tolist(), (middle_m + half_m).tolist()
    columns = min(len(design.titles), PANELS)
    lines = -(-len(design.titles) // columns)
    height = 1.1 + 2.8 * min(max((top - bottom) / (right - left), 0.4), 1.6)
    figure = Figure(figsize=(3.4 * columns, height * lines + 0.3), layout="compressed")
    panels = np.atleast_1d(figure.subplots(lines, columns, sharex=True, sharey=True)).ravel().tolist()
    for unused in panels[len(design.titles) :]:
        unused.remove()
    for k, (axes, title) in enumerate(zip(panels, design.titles, strict=False)):
        part = pose[k * rows : (k + 1) * rows + 1]
        axes.plot((left, right, right, left, left), (bottom, bottom, top, top, bottom), color=GREY, linewidth=1.0)
        if commands[k * rows : (k + 1) * rows, 0].any():
            axes.plot(part[:, 0], part[:, 1], color=BLUE, zorder=3)
        else:
            _draw_turn(axes, part, 0.25 * min(half_m))
        axes.plot(*part[0, :2], "o", color=BLACK, markersize=4, zorder=4)
        heading = np.cos(part[0, 2]), np.sin(part[0, 2])
        axes.quiver(*part[0, :2], *heading, color=BLACK, scale=14.0, width=0.006, zorder=2)
        axes.set_aspect("equal")
        finished(axes, fill(f"{k + 1}. {title}", TITLE), "x [m]", "y [m]" if k % columns == 0 else "", legend=False)
        axes.title.set_fontsize("small")
    figure.legend(handles=_legend(), loc="outside lower left", ncols=2 if columns < WIDE else 4, fontsize="x-small")
    return png(figure)


def _draw_turn(axes: Axes, part: Array, radius_m: float) -> None:
    """Draw a turn on the spot as a spiral around the place, which the heading passes, with arrows where it ends."""
    turned = part[:, 2] - part[0, 2]
    furthest = float(turned[np.argmax(np.abs(turned))])
    share = np.linspace(0.0, 1.0, 200)
    angle, radius = part[0, 2] + furthest * share, radius_m * (0.7 + 0.6 * share)
    x, y = part[0, 0] + radius * np.cos(angle), part[0, 1] + radius * np.sin(angle)
    axes.plot(x, y, color=BLUE, zorder=3)
    is_back = abs(turned[-1]) < 0.5 * abs(furthest)
    for end, before in ((-1, -8), *(((0, 7),) if is_back else ())):
        shape = {"arrowstyle": "-|>", "color": BLUE, "shrinkA": 0.0, "shrinkB": 0.0}
        axes.annotate("", (x[end], y[end]), (x[before], y[before]), arrowprops=shape)


def _legend() -> list[Line2D]:
    """Return the entries of the legend of the figure."""
    return [
        Line2D([], [], color=BLUE, label="path of the middle of the axle"),
        Line2D([], [], color=BLUE, marker="$\\circlearrowleft$", markersize=9, linestyle="", label="turn on the spot"),
        Line2D([], [], color=BLACK, marker="o", markersize=4, label="start and heading"),
        Line2D([], [], color=GREY, linewidth=1.0, label="border of the floor"),
    ]


def start_text(design: TrialDesign) -> str:
    """Return the pose at which the drive begins in words."""
    x_m, y_m, yaw_rad = start_of(design.limits).tolist()
    return f"x = {x_m:.3g} m, y = {y_m:.3g} m, theta = {yaw_rad:.3g} rad"
