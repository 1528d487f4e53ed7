"""Readings of each channel across the tape at two heights of the sensor, and the width of the edge of the tape."""

import numpy as np
from scipy.special import ndtri

from configs.schema.robot import LineSensor, RobotConfig
from diagnosis.validation.experiment import ExperimentResult, ValidationCheck
from diagnosis.validation.line_sensor.rig import Tape, readings, sensor, spot_diameter_m, without_faults
from diagnosis.validation.measures import rms
from diagnosis.validation.panels import COLORS, MARKERS, Curve, Panel
from sensors.line.line_sensor import channel_weights
from symolo.core.arrays import Array
from symolo.pages.plotting import BLUE, VERMILION

HEIGHT_FACTORS = (1.0, 2.0)
"""Factors on the configured height. For the QTR-8A, its maker gives 3 mm as optimal and recommends at most 6 mm."""
FINE_POINTS = 1001
COARSE_POINTS = 81
MAX_SPOT_SHARE = 0.15
"""Largest standard deviation of the spot, as a share of the width of the tape, for which the two edges are apart."""
TOLERANCE = 0.005
"""Largest relative difference from the closed form."""


def edges(robot: RobotConfig, seed: int) -> ExperimentResult:
    """Return readings across the tape and the width of its edge, at both heights."""
    config, tape = robot.line_sensor, Tape()
    tables, checks, panels, across = {}, [], [], []
    for factor, color, style in zip(HEIGHT_FACTORS, (BLUE, VERMILION), ("-", "--"), strict=True):
        height_m = config.height_m * factor
        table = crossing(config, height_m, tape, seed)
        name = f"{1e3 * height_m:g} mm high"
        tables[name] = table
        closed_m = table["edge_closed_form_m"]
        widths = table["edge_10_90_m"]
        # The closed form is that of one edge; a spot that sees both edges is only compared with it.
        tolerance = 1e3 * TOLERANCE * closed_m if table["edges_are_apart"] else None
        worst = float(widths[np.argmax(np.abs(widths - closed_m))])
        source = "2.563 standard deviations of the spot"
        checks.append(ValidationCheck(f"edge 10-90 %, {name}", 1e3 * worst, 1e3 * closed_m, tolerance, source, "mm"))
        panels += _panels(name, table, config.threshold)
        ink = (tape.floor_reflectance - table["faultless_L4"]) / (tape.floor_reflectance - tape.reflectance)
        from_middle = 1e3 * (table["offset_m"] + table["channel_y_m"][4])
        across.append(Curve(from_middle, 100.0 * ink, name, color, style))
        half_mm, closed_mm = 0.5e3 * tape.width_m, 1e3 * closed_m
        across.append(Curve([half_mm - 0.5 * closed_mm, half_mm + 0.5 * closed_mm], [90.0, 10.0], "", color, "o"))
    title = "Edge of the tape under L4, points from the closed form"
    spot = ("spot from the tape's middle [mm]", "tape in the spot [%]")
    panels.append(Panel(title, *spot, across, (0.5e3 * tape.width_m,), (10.0, 90.0), (0.0, 1e3 * tape.width_m)))
    return ExperimentResult(tables, checks, panels)


def crossing(config: LineSensor, height_m: float, tape: Tape, seed: int) -> dict:
    """Return the readings of a faultless sensor and of a drawn one at one height, and the widths of the edge."""
    at_height = config.model_copy(update={"height_m": height_m})
    diameter_m = spot_diameter_m(config, height_m)
    channel_y_m = channel_weights(config.channels) * config.pitch_m
    reach_m = float(channel_y_m.max()) + tape.width_m + diameter_m
    fine, coarse = np.linspace(-reach_m, reach_m, FINE_POINTS), np.linspace(-reach_m, reach_m, COARSE_POINTS)
    quiet = sensor(without_faults(at_height), tape, seed)
    faultless = readings(quiet, fine)
    # The same random stream gives the same sensor at both heights.
    sampled = readings(sensor(at_height, tape, seed, "crossing"), coarse)
    return {
        "height_m": height_m,
        "spot_diameter_m": diameter_m,
        "channel_y_m": channel_y_m,
        "offset_m": fine,
        **{f"faultless_L{k}": channel for k, channel in enumerate(faultless.T)},
        "sampled_offset_m": coarse,
        **{f"sampled_L{k}": channel for k, channel in enumerate(sampled.T)},
        "residual_rms": rms(sampled - readings(quiet, coarse)),
        "edge_10_90_m": np.array([edge_width_m(fine, channel, tape) for channel in faultless.T]),
        "edge_closed_form_m": 2.0 * float(ndtri(0.9)) * 0.25 * diameter_m,
        "edges_are_apart": 0.25 * diameter_m <= MAX_SPOT_SHARE * tape.width_m,
    }


def edge_width_m(offset_m: Array, reading: Array, tape: Tape) -> float:
    """Return the distance from 10 to 90 % of the contrast between floor and tape, the mean of both edges."""
    ink = (tape.floor_reflectance - reading) / (tape.floor_reflectance - tape.reflectance)
    middle = int(np.argmax(ink))
    rise = np.interp([0.1, 0.9], ink[: middle + 1], offset_m[: middle + 1])
    fall = np.interp([0.1, 0.9], ink[middle:][::-1], offset_m[middle:][::-1])
    return 0.5 * float(rise[1] - rise[0] + fall[0] - fall[1])


def _panels(name: str, table: dict, threshold: float) -> tuple[Panel, Panel]:
    offset, sampled = 1e3 * table["offset_m"], 1e3 * table["sampled_offset_m"]
    curves, residuals = [], []
    for k, (color, marker) in enumerate(zip(COLORS, MARKERS, strict=True)):
        faultless, drawn = table[f"faultless_L{k}"], table[f"sampled_L{k}"]
        curves.append(Curve(offset, faultless, "", color, width=1))
        curves.append(Curve(sampled, drawn, f"L{k}", color, marker, size=3))
        residuals.append(Curve(sampled, drawn - np.interp(sampled, offset, faultless), "", color, marker, size=2.5))
    x = "robot left of the tape's middle [mm]"
    title = f"Sensor {name}: points one drawn sensor, lines faultless, dashed the threshold"
    return (
        Panel(title, x, "reading [1 is white]", curves, y_lines=(threshold,), y_range=(0.0, 1.0)),
        Panel(f"Sensor {name}: drawn minus faultless", x, "reading [1]", residuals, y_lines=(0.0,)),
    )
