"""The picture of the five experiments: ours as lines, the paper's numbers as points."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from diagnosis.validation.range_sensor.experiments import TofBench
from diagnosis.validation.range_sensor.paper import footprint_mm
from diagnosis.validation.range_sensor.step import EDGE_MM
from diagnosis.validation.range_sensor.surfaces import OverDistance, Surfaces
from diagnosis.validation.range_sensor.tilt import TiltCurve
from sensors.tof import log_error_m, noise_sd_m
from symolo.core.arrays import Array
from symolo.pages.plotting import BLACK, BLUE, GREEN, GREY, ORANGE, PALE, PURPLE, SKY, VERMILION, finished, png

COLORS = (BLACK, BLUE, VERMILION, GREEN, PURPLE, ORANGE)
DASHES = ("-", "--", "-.", ":", (0, (6, 1.5, 1, 1.5, 1, 1.5)), (0, (1, 1)))
MARKS = ("o", "s", "^", "v", "D", "P")


def tof_picture(bench: TofBench) -> bytes:
    """PNG, three by three; what the paper prints is black, for "paper" is a material too."""
    figure = Figure(figsize=(17, 14.5), layout="constrained")
    figure.suptitle(f"Range bench: robot {bench.robot}")
    axes = figure.subplots(3, 3)
    _means_at_hundred(axes[0, 0], bench)
    _deviations_at_hundred(axes[0, 1], bench)
    _errors(axes[0, 2], bench.tones, "1  Tones: mean less distance")
    _equation_24(axes[0, 2], bench.error_scale)
    _deviations(axes[1, 0], bench.tones)
    _errors(axes[1, 1], bench.materials, "2  Materials: mean less distance")
    _steps(axes[1, 2], bench)
    _widths(axes[2, 0], bench)
    _tilts(axes[2, 1], bench.tilt)
    _spots(axes[2, 2], bench)
    return png(figure)


def _rows(bench: TofBench) -> tuple[list[str], Array]:
    """Names of the nine surfaces, and mean, deviation, printed mean, printed deviation of each, (9, 4)."""
    table = (*bench.tones.table, *bench.materials.table)
    names = [row.surface.replace("_board", "").replace("_", " ") for row in table]
    return names, np.array([[row.mean_mm, row.sd_mm, row.paper_mean_mm, row.paper_sd_mm] for row in table])


def _means_at_hundred(axes: Axes, bench: TofBench) -> None:
    names, table = _rows(bench)
    places = np.arange(len(names))
    axes.errorbar(
        places, table[:, 2], yerr=0.5, fmt="none", ecolor=GREY, elinewidth=9, alpha=0.45, label="printed ± 0.5 mm"
    )
    axes.plot(places, table[:, 2], "o", color=BLACK, markersize=8, markerfacecolor="none", label="printed, Tables 3, 4")
    axes.plot(places, table[:, 0], "x", color=VERMILION, markersize=8, markeredgewidth=2, label="simulated")
    _name_surfaces(axes, names)
    finished(axes, "1, 2  Mean at 100 mm", "", "mean reading [mm]", loc="lower right")


def _deviations_at_hundred(axes: Axes, bench: TofBench) -> None:
    names, table = _rows(bench)
    places = np.arange(len(names))
    axes.bar(places, 0.3 * table[:, 3], 0.5, bottom=0.85 * table[:, 3], color=PALE, label="printed ± 15 %")
    axes.plot(places, table[:, 3], "o", color=BLACK, markersize=8, markerfacecolor="none", label="printed, Tables 3, 4")
    axes.plot(places, table[:, 1], "x", color=VERMILION, markersize=8, markeredgewidth=2, label="simulated")
    axes.set_ylim(0.0, 1.3 * table[:, 3].max())
    _name_surfaces(axes, names)
    finished(axes, "1, 2  Deviation at 100 mm", "", "standard deviation [mm]", loc="upper left")


def _name_surfaces(axes: Axes, names: list[str]) -> None:
    axes.set_xticks(range(len(names)), names, rotation=35, ha="right", rotation_mode="anchor")


def _values(column: tuple[float | None, ...]) -> Array:
    return np.array([np.nan if value is None else value for value in column])


def _errors(axes: Axes, surfaces: Surfaces, title: str) -> None:
    for number, curve in enumerate(surfaces.curves):
        off = _values(curve.mean_mm) - curve.distance_mm
        axes.plot(curve.distance_mm, off, color=COLORS[number], linestyle=DASHES[number], label=_name(curve))
    for number, row in enumerate(surfaces.table):
        label = "printed, at 100 mm" if number == 0 else None
        axes.plot(
            100.0,
            row.paper_mean_mm - 100.0,
            MARKS[number],
            color=COLORS[number],
            markeredgecolor=BLACK,
            markersize=7,
            label=label,
            zorder=3,
        )
    finished(axes, title, "distance [mm]", "mean reading less distance [mm]", loc="upper left")


def _equation_24(axes: Axes, scale: float) -> None:
    distance = np.linspace(40.0, 1200.0, 200)
    label = f"Eq. 24 in full; the robot takes {scale:g} of it"
    axes.plot(distance, 1e3 * log_error_m(1e-3 * distance), color=GREY, linewidth=3, alpha=0.6, label=label)
    axes.set_ylim(top=1.45 * axes.get_ylim()[1])
    axes.legend(fontsize="small", loc="upper left")


def _name(curve: OverDistance) -> str:
    return "simulated, " + curve.surface.replace("_board", "").replace("_", " ")


def _deviations(axes: Axes, tones: Surfaces) -> None:
    for number, curve in enumerate(tones.curves):
        axes.plot(
            curve.distance_mm,
            _values(curve.sd_mm),
            MARKS[number],
            color=COLORS[number],
            markersize=4,
            markerfacecolor="none",
            label=_name(curve),
        )
    distance = np.linspace(40.0, 1200.0, 200)
    equation = 1e3 * noise_sd_m(np.full_like(distance, 1.41e-3), 1e-3 * distance)
    axes.plot(distance, equation, color=GREY, linewidth=3, alpha=0.7, label="Eq. 23, in x - 0.18 m")
    axes.set_ylim(bottom=0.0)
    finished(axes, "1  Tones: deviation", "distance [mm]", "standard deviation [mm]", loc="upper left")


def _steps(axes: Axes, bench: TofBench) -> None:
    for number, scan in enumerate(bench.step):
        position = np.array(scan.position_mm) - EDGE_MM
        readings = _values(scan.reading_mm)
        axes.plot(position, readings, ".", color=COLORS[number], markersize=2, alpha=0.5)
        label = f"at {scan.distance_mm:.0f} mm"
        axes.plot(position, scan.noiseless_mm, color=COLORS[number], linestyle=DASHES[number], label=label)
        half = 0.5 * scan.footprint_mm
        axes.plot([-half, half], [scan.before_mm, scan.after_mm], "k|", markersize=10, markeredgewidth=2)
    axes.plot([], [], "k|", markersize=10, markeredgewidth=2, label="paper: edges of 2 d tan 12.5°")
    axes.set_ylim(0.0, 640.0)
    finished(axes, "3  Step of 106 mm", "position from the edge [mm]", "reading [mm]", loc="upper left", ncols=2)


def _widths(axes: Axes, bench: TofBench) -> None:
    distance = np.array([scan.distance_mm for scan in bench.step])
    footprint = np.array([footprint_mm(value) for value in distance])
    axes.fill_between(distance, 0.9 * footprint, 1.1 * footprint, color=PALE, label="± 10 %")
    axes.plot(distance, footprint, "o", color=BLACK, markersize=8, markerfacecolor="none", label="paper: 2 d tan 12.5°")
    axes.plot(
        distance, 0.687 * footprint, color=SKY, linestyle=":", linewidth=2.5, label="10-90 % of a disc of even light"
    )
    narrow = [scan.width_10_90_mm for scan in bench.step]
    nearly = [scan.width_1_99_mm for scan in bench.step]
    axes.plot(distance, narrow, "x-", color=VERMILION, markeredgewidth=2, label="simulated, 10-90 %")
    axes.plot(distance, nearly, "+--", color=BLUE, markersize=9, markeredgewidth=2, label="simulated, 1-99 %")
    finished(axes, "3  Width of the step", "distance to the box [mm]", "width [mm]", loc="upper left")


def _tilts(axes: Axes, curves: tuple[TiltCurve, ...]) -> None:
    aside, up = ([curve for curve in curves if curve.axis == axis] for axis in ("sideways", "up_and_down"))
    for number, curve in enumerate(aside):
        color = COLORS[number]
        axes.plot(curve.angle_deg, curve.noiseless_mm, color=color, linestyle=DASHES[number])
        axes.plot(
            curve.angle_deg,
            curve.mean_mm,
            MARKS[number],
            color=color,
            markersize=4,
            markerfacecolor="none",
            label=f"at {curve.distance_mm:.0f} mm",
        )
    for number, curve in enumerate(up):
        label = "up and down" if number == 0 else None
        axes.plot(curve.angle_deg, curve.mean_mm, "+", color=GREY, markersize=7, label=label)
    distance = [curve.distance_mm for curve in aside]
    level = [0.0] * len(distance)
    axes.plot(level, distance, "o", color=BLACK, markersize=9, markerfacecolor="none", label="distance, at 0°")
    axes.set_ylim(0.0, 620.0)
    title = "4  Tilt: means to the sides, lines without noise"
    finished(axes, title, "angle [°]", "mean reading [mm]", loc="upper left", ncols=2)


def _spots(axes: Axes, bench: TofBench) -> None:
    distance = [spot.distance_mm for spot in bench.field_of_view]
    paper = [spot.paper_mm for spot in bench.field_of_view]
    ours = [spot.diameter_mm for spot in bench.field_of_view]
    axes.plot(distance, paper, "o", color=BLACK, markersize=8, markerfacecolor="none", label="paper: 2 d tan 12.5°")
    axes.plot(distance, ours, "x-", color=VERMILION, markeredgewidth=2, label="simulated, outermost ray")
    axes.set_ylim(bottom=0.0)
    finished(axes, "5  Field of view", "distance [mm]", "diameter [mm]", loc="upper left")
