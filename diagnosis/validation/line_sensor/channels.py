"""How channels differ between robots, and what the converter makes of a reading."""

from dataclasses import dataclass

import numpy as np

from configs.schema.robot import LineSensor
from diagnosis.validation.line_sensor.rig import FAR_M, Standing, Tape, sensor, without_faults
from symolo.core.arrays import Array

ROBOTS = 500
DARK, LIGHT = 0.25, 0.65
"""Bare floors between which a gain is measured; with the shipped spreads no channel saturates on them."""
POINTS_PER_LEVEL = 2
MAX_BITS_SWEPT = 12
"""Finer converters are swept over their lowest 4096 levels only."""


@dataclass(frozen=True)
class Spread:
    """Of one quantity over all channels of all robots drawn."""

    values: tuple[float, ...]
    mean: float
    sd: float
    configured_sd: float
    sd_error: float
    """Standard error of `sd` for so many draws of a normal distribution."""

    @classmethod
    def of(cls, values: Array, configured_sd: float) -> "Spread":
        return cls(
            values=tuple(values.tolist()),
            mean=float(values.mean()),
            sd=float(values.std(ddof=1)),
            configured_sd=configured_sd,
            sd_error=configured_sd / float(np.sqrt(2.0 * (len(values) - 1))),
        )


@dataclass(frozen=True)
class Channels:
    robots: int
    gain: Spread
    offset: Spread


@dataclass(frozen=True)
class Converter:
    """Bare floors of finely rising reflectance under a sensor without spread and noise."""

    bits: int
    reflectance: tuple[float, ...]
    reading: tuple[float, ...]
    levels: int
    """Different readings found."""
    levels_expected: int
    step: float
    """Between neighbouring readings, the largest found."""
    step_closed_form: float
    """1 / (2^bits - 1): full scale is white."""
    largest_error: float
    """Of a reading; half a step in theory."""


def channels(config: LineSensor, seed: int) -> Channels:
    """Gain and offset of every channel of many robots, from two bare floors, without noise and converter."""
    spread = without_faults(config, gain_sd=config.gain_sd, offset_sd=config.offset_sd)
    # The same stream on both floors makes the same sensor.
    dark, light = (
        np.array([_on_floor(spread, level, seed, "channels", robot) for robot in range(ROBOTS)])
        for level in (DARK, LIGHT)
    )
    gain = (light - dark) / (LIGHT - DARK)
    offset = dark - gain * DARK
    return Channels(ROBOTS, Spread.of(gain.ravel(), config.gain_sd), Spread.of(offset.ravel(), config.offset_sd))


def converter(config: LineSensor, seed: int) -> Converter:
    quiet = without_faults(config, adc_bits=config.adc_bits)
    bits = min(config.adc_bits, MAX_BITS_SWEPT)
    full, swept = 2**config.adc_bits - 1, 2**bits - 1
    reflectance = np.linspace(0.0, swept / full, POINTS_PER_LEVEL * swept + 1)
    reading = np.array([_on_floor(quiet, level, seed, "converter")[0] for level in reflectance.tolist()])
    found = np.unique(reading)
    return Converter(
        bits=config.adc_bits,
        reflectance=tuple(reflectance.tolist()),
        reading=tuple(reading.tolist()),
        levels=len(found),
        levels_expected=swept + 1,
        step=float(np.diff(found).max()),
        step_closed_form=1.0 / full,
        largest_error=float(np.abs(reading - reflectance).max()),
    )


def _on_floor(config: LineSensor, reflectance: float, seed: int, *key: str | int) -> Array:
    """(8,), far from any tape."""
    model = sensor(config, Tape(floor_reflectance=reflectance), seed, *key)
    return model.sample(Standing(FAR_M))
