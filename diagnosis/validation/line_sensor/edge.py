"""Across the tape at two heights: what each channel reads, and how wide the edge of the tape is to it."""

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri

from configs.schema.robot import LineSensor
from diagnosis.validation.line_sensor.rig import Tape, readings, sensor, spot_diameter_m, without_faults
from sensors.line_sensor import channel_weights
from symolo.core.arrays import Array

HEIGHT_FACTORS = (1.0, 2.0)
"""Of the configured height; the QTR-8A's 3 mm are optimal, 6 mm the most that its maker recommends."""
FINE_POINTS = 1001
COARSE_POINTS = 81
WIDEST_SPOT_SHARE = 0.15
"""Standard deviation of the spot over the tape's width, up to which its two edges are apart."""


@dataclass(frozen=True)
class Crossing:
    """One height."""

    height_m: float
    spot_diameter_m: float
    channel_y_m: tuple[float, ...]
    """(8,), to the robot's left."""
    offset_m: tuple[float, ...]
    """Of the robot to the left of the tape's middle, (N,)."""
    faultless: tuple[tuple[float, ...], ...]
    """(8, N), L0 first: equal channels, no noise, the finest converter."""
    sampled_offset_m: tuple[float, ...]
    sampled: tuple[tuple[float, ...], ...]
    """(8, M), one reading each of the sensor as configured, with gains and offsets drawn."""
    residual_rms: float
    """Of the sampled readings less the faultless ones."""
    edge_10_90_m: tuple[float, ...]
    """(8,), from 10 to 90 % of the contrast, mean of both edges."""
    edge_closed_form_m: float
    """2.563 standard deviations of the spot, which is a quarter of a disc's diameter."""
    edges_are_apart: bool
    """Whether the spot is so much smaller than the tape that the closed form for one edge holds."""


def crossings(config: LineSensor, tape: Tape, seed: int) -> tuple[Crossing, ...]:
    return tuple(_crossing(config, config.height_m * factor, tape, seed) for factor in HEIGHT_FACTORS)


def _crossing(config: LineSensor, height_m: float, tape: Tape, seed: int) -> Crossing:
    at_height = config.model_copy(update={"height_m": height_m})
    diameter_m = spot_diameter_m(config, height_m)
    channel_y_m = channel_weights(config.channels) * config.pitch_m
    reach_m = float(channel_y_m.max()) + tape.width_m + diameter_m
    fine, coarse = np.linspace(-reach_m, reach_m, FINE_POINTS), np.linspace(-reach_m, reach_m, COARSE_POINTS)
    quiet = sensor(without_faults(at_height), tape, seed)
    faultless = readings(quiet, fine)
    # The same stream at both heights is the same sensor, raised.
    sampled = readings(sensor(at_height, tape, seed, "crossing"), coarse)
    residual = sampled - readings(quiet, coarse)
    return Crossing(
        height_m=height_m,
        spot_diameter_m=diameter_m,
        channel_y_m=tuple(channel_y_m.tolist()),
        offset_m=tuple(fine.tolist()),
        faultless=tuple(map(tuple, faultless.T.tolist())),
        sampled_offset_m=tuple(coarse.tolist()),
        sampled=tuple(map(tuple, sampled.T.tolist())),
        residual_rms=float(np.sqrt(np.mean(residual**2))),
        edge_10_90_m=tuple(edge_width_m(fine, channel, tape) for channel in faultless.T),
        edge_closed_form_m=2.0 * float(ndtri(0.9)) * 0.25 * diameter_m,
        edges_are_apart=0.25 * diameter_m <= WIDEST_SPOT_SHARE * tape.width_m,
    )


def edge_width_m(offset_m: Array, reading: Array, tape: Tape) -> float:
    """From 10 to 90 % of the contrast between floor and tape, mean of both edges, straight between points."""
    ink = (tape.floor_reflectance - reading) / (tape.floor_reflectance - tape.reflectance)
    middle = int(np.argmax(ink))
    rise = np.interp([0.1, 0.9], ink[: middle + 1], offset_m[: middle + 1])
    fall = np.interp([0.1, 0.9], ink[middle:][::-1], offset_m[middle:][::-1])
    return 0.5 * float(rise[1] - rise[0] + fall[0] - fall[1])
