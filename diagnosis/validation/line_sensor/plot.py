"""The picture of the line bench: both crossings with residuals, spread of the channels, converter, line error."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from diagnosis.validation.line_sensor.bench import LineBench
from diagnosis.validation.line_sensor.channels import Channels, Converter
from diagnosis.validation.line_sensor.edge import Crossing
from diagnosis.validation.line_sensor.threshold import Threshold
from symolo.pages.plotting import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PURPLE,
    SKY,
    VERMILION,
    finished,
    png,
)

CHANNEL_COLORS = (BLACK, ORANGE, SKY, GREEN, GREY, BLUE, VERMILION, PURPLE)
CHANNEL_MARKERS = ("o", "s", "^", "v", "D", "P", "X", "*")
HISTOGRAM_SDS = 4.0
ZOOMED_STEPS = 6


def line_picture(bench: LineBench) -> bytes:
    """PNG; a column for each height on top, below them the channels, the converter and the line error."""
    figure = Figure(figsize=(12, 13), layout="constrained")
    grid = figure.add_gridspec(4, 6, height_ratios=(3, 1.5, 2.4, 2.4))
    first: Axes | None = None
    for column, crossing in enumerate(bench.crossings):
        over = figure.add_subplot(grid[0, 3 * column : 3 * column + 3], sharey=first)
        first = first or over
        under = figure.add_subplot(grid[1, 3 * column : 3 * column + 3], sharex=over)
        _crossing(over, under, crossing, bench.threshold.threshold)
    _edge(figure.add_subplot(grid[2, :3]), bench.crossings, bench)
    _gains(figure.add_subplot(grid[2, 3:]), bench.channels)
    _converter(figure.add_subplot(grid[3, :3]), bench.converter)
    _errors(figure.add_subplot(grid[3, 3:]), bench.threshold)
    figure.suptitle(f"Line bench: robot {bench.robot}, tape {1e3 * bench.tape.width_m:g} mm wide")
    return png(figure)


def _crossing(over: Axes, under: Axes, crossing: Crossing, threshold: float) -> None:
    offset, sampled = 1e3 * np.array(crossing.offset_m), 1e3 * np.array(crossing.sampled_offset_m)
    models, points = np.array(crossing.faultless), np.array(crossing.sampled)
    for channel, (color, marker) in enumerate(zip(CHANNEL_COLORS, CHANNEL_MARKERS, strict=True)):
        over.plot(offset, models[channel], color=color, lw=1)
        over.plot(sampled, points[channel], marker, color=color, ms=3, label=f"L{channel}")
        residual = points[channel] - np.interp(sampled, offset, models[channel])
        under.plot(sampled, residual, marker, color=color, ms=2.5)
    over.axhline(threshold, color=GREY, ls="--", lw=1, label="threshold")
    over.set_ylim(0.0, 1.0)
    title = f"Sensor {1e3 * crossing.height_m:g} mm high: points one drawn sensor, lines faultless"
    finished(over, title, "robot left of the tape's middle [mm]", "reading [1 is white]", beside=True)
    under.axhline(0.0, color=GREY, lw=0.8)
    finished(under, "drawn less faultless", "robot left of the tape's middle [mm]", "reading [1]", legend=False)


def _edge(axes: Axes, crossings: tuple[Crossing, ...], bench: LineBench) -> None:
    """One edge of the tape under channel 4, against the distance of the spot's middle from the tape's."""
    contrast = bench.tape.floor_reflectance - bench.tape.reflectance
    for crossing, (color, dashes) in zip(crossings, ((BLUE, "-"), (VERMILION, "--")), strict=True):
        ink = (bench.tape.floor_reflectance - np.array(crossing.faultless[4])) / contrast
        offset = 1e3 * (np.array(crossing.offset_m) + crossing.channel_y_m[4])
        width, closed = 1e3 * crossing.edge_10_90_m[4], 1e3 * crossing.edge_closed_form_m
        label = f"{1e3 * crossing.height_m:g} mm high: {width:.2f} mm, closed form {closed:.2f} mm"
        axes.plot(offset, 100.0 * ink, dashes, color=color, label=label)
        edge = 0.5e3 * bench.tape.width_m
        axes.plot([edge - 0.5 * closed, edge + 0.5 * closed], [90.0, 10.0], "o", color=color, ms=5)
    for level in (10.0, 90.0):
        axes.axhline(level, color=GREY, lw=0.8, ls=":")
    axes.axvline(0.5e3 * bench.tape.width_m, color=GREY, lw=0.8)
    axes.set_xlim(0.0, 1e3 * bench.tape.width_m)
    axes.set_ylim(-3.0, 135.0)
    axes.set_yticks(range(0, 101, 20))
    finished(
        axes,
        "Edge of the tape under L4: points by the closed form",
        "spot from the tape's middle [mm]",
        "tape in the spot [%]",
    )


def _gains(axes: Axes, channels: Channels) -> None:
    gain = channels.gain
    reach = HISTOGRAM_SDS * max(gain.configured_sd, gain.sd, 1e-6)
    bins = np.linspace(1.0 - reach, 1.0 + reach, 41)
    label = f"{len(gain.values)} channels: sd {gain.sd:.4f}"
    axes.hist(gain.values, bins=bins.tolist(), density=True, color=SKY, edgecolor=BLUE, lw=0.5, label=label)
    if gain.configured_sd > 0.0:
        x = np.linspace(bins[0], bins[-1], 201)
        density = np.exp(-0.5 * ((x - 1.0) / gain.configured_sd) ** 2) / (gain.configured_sd * np.sqrt(2.0 * np.pi))
        axes.plot(x, density, color=BLACK, label=f"configured: sd {gain.configured_sd:.4f}")
    axes.set_ylim(top=1.25 * axes.get_ylim()[1])
    finished(axes, f"Gains of the channels of {channels.robots} robots", "gain [1]", "density [1]")


def _converter(axes: Axes, converter: Converter) -> None:
    reflectance, reading = np.array(converter.reflectance), np.array(converter.reading)
    step, middle = converter.step_closed_form, len(reflectance) // 2
    near = slice(max(0, middle - 2 * ZOOMED_STEPS), middle + 2 * ZOOMED_STEPS + 1)
    origin = np.floor(reflectance[near][0] / step)
    x = np.linspace(reflectance[near][0], reflectance[near][-1], 1001)
    axes.plot(x / step - origin, np.round(x / step) - origin, color=BLUE, lw=1, label="rounded to whole steps")
    axes.plot(x / step - origin, x / step - origin, ":", color=GREY, label="without a converter")
    axes.plot(
        reflectance[near] / step - origin, reading[near] / step - origin, "o", color=BLACK, ms=4, label="readings"
    )
    title = f"Converter, {converter.bits} bits: {converter.levels} levels, a step is {converter.step:.6f}"
    finished(axes, title, f"reflectance [steps from {origin:.0f}]", f"reading [steps from {origin:.0f}]")


def _errors(axes: Axes, threshold: Threshold) -> None:
    error = [np.nan if value is None else value for value in threshold.line_error]
    axes.plot(
        1e3 * np.array(threshold.offset_m), error, ".", color=BLUE, ms=3, label="mean weight of channels on (Eq. 12)"
    )
    for number, case in enumerate(threshold.cases):
        label = "the paper's Fig. 5" if number == 0 else None
        x, y = 1e3 * case.offset_m, case.line_error_in_figure_5
        axes.plot(x, y, "o", mfc="none", color=VERMILION, ms=9, mew=1.5, label=label)
    finished(axes, "Line error with the threshold", "robot left of the tape's middle [mm]", "line error [pitches]")
