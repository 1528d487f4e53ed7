"""The files of a designed drive: its path, set points for a board, and a controller and a scenario that drive it."""

from collections.abc import Iterator, Mapping
from math import degrees
from textwrap import fill

import numpy as np
import yaml
from matplotlib.figure import Figure

from diagnosis.importers.drive_log import ROW_S
from diagnosis.next_trial.design import TrialDesign
from diagnosis.next_trial.library.drive_log import start_of, wheel_speeds
from diagnosis.next_trial.library.manoeuvres import path_of
from diagnosis.next_trial.template import nominal_drive
from symolo.core.arrays import Array
from symolo.pages.plotting import BLACK, BLUE, GREY, finished, png

PATH, FIGURE, SPEEDS, CONTROLLER, SCENARIO = "path.csv", "path.png", "wheel_speeds.h", "next_drive.py", "scenario.yaml"
PANELS, TITLE = 4, 36
"""Panels of the figure beside each other, and letters in a line of their titles."""
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
    """Return a scenario in which the robot drives on an empty floor."""
    x_m, y_m, yaw_rad = planned_path(design)[0].tolist()
    start = {"x_m": round(x_m, 4), "y_m": round(y_m, 4), "yaw_deg": round(degrees(yaw_rad), 3)}
    scenario = {
        "extends": "smoke",
        "name": "next_drive",
        "description": "The drive that symolo next has designed, on an empty floor",
        "routes": [{"name": "drive", "start": start, "runs": 1}],
        "stop": {"lap": False, "time_limit_s": float(design.trial.trials[0].t_s[-1])},
        "rates": {"control_hz": round(1.0 / ROW_S)},
        "arena": {"extends": "symolo", "walls": [], "obstacles": []},
        "robot": "nominal",
    }
    return yaml.safe_dump(scenario, sort_keys=False)


def _figure(design: TrialDesign) -> bytes:
    """Return the planned path from above, a panel for each manoeuvre, as PNG."""
    pose, rows = planned_path(design), len(_commands(design)) // len(design.titles)
    middle_m, half_m = np.array(design.limits.middle_m), 0.5 * np.array(design.limits.floor_m)
    (left, bottom), (right, top) = (middle_m - half_m).tolist(), (middle_m + half_m).tolist()
    columns = min(len(design.titles), PANELS)
    lines = -(-len(design.titles) // columns)
    figure = Figure(figsize=(3.4 * columns, 3.4 * lines), layout="constrained")
    panels = np.atleast_1d(figure.subplots(lines, columns, sharex=True, sharey=True)).ravel().tolist()
    for unused in panels[len(design.titles) :]:
        unused.remove()
    for k, (axes, title) in enumerate(zip(panels, design.titles, strict=False)):
        part = pose[k * rows : (k + 1) * rows + 1]
        axes.plot((left, right, right, left, left), (bottom, bottom, top, top, bottom), color=GREY, linewidth=1.0)
        axes.plot(part[:, 0], part[:, 1], color=BLUE)
        axes.plot(*part[0, :2], "o", color=BLACK, markersize=5)
        axes.quiver(*part[0, :2], np.cos(part[0, 2]), np.sin(part[0, 2]), color=BLACK, scale=9.0, width=0.012)
        axes.set_aspect("equal")
        finished(axes, fill(f"{k + 1}. {title}", TITLE), "x [m]", "y [m]" if k % columns == 0 else "", legend=False)
        axes.title.set_fontsize("small")
    return png(figure)


def start_text(design: TrialDesign) -> str:
    """Return the pose at which the drive begins in words."""
    x_m, y_m, yaw_rad = start_of(design.limits).tolist()
    return f"x = {x_m:.3g} m, y = {y_m:.3g} m, theta = {yaw_rad:.3g} rad"
