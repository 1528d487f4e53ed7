"""Differences of the channels between robots, and the steps of the converter."""

import numpy as np

from configs.schema.robot import LineSensor, RobotConfig
from diagnosis.validation.experiment import ExperimentResult, ValidationCheck
from diagnosis.validation.line_sensor.rig import FAR_M, Tape, readings, sensor, without_faults
from diagnosis.validation.panels import Curve, Panel
from symolo.core.arrays import Array
from symolo.pages.plotting import BLACK, BLUE, GREY, SKY

ROBOTS = 500
DARK, LIGHT = 0.25, 0.65
"""Reflectances of the bare floors between which a gain is measured; no channel saturates with the shipped spreads."""
POINTS_PER_LEVEL = 2
MAX_BITS_SWEPT = 12
"""Number of bits above which a converter is swept only over its lowest 4096 levels."""
MAX_STANDARD_ERRORS = 5.0
HISTOGRAM_SDS = 4.0
ZOOMED_STEPS = 6
ROUNDING = 1e-6
"""Relative tolerance of figures that are exact but for rounding."""


def channels(robot: RobotConfig, seed: int) -> ExperimentResult:
    """Return gain and offset of every channel of many robots, from readings of two bare floors without noise."""
    config = robot.line_sensor
    drawn = without_faults(config, gain_sd=config.gain_sd, offset_sd=config.offset_sd)
    # The same random stream gives the same sensor on both floors.
    dark, light = (
        np.array([_on_floor(drawn, level, seed, "channels", number) for number in range(ROBOTS)])
        for level in (DARK, LIGHT)
    )
    gain = ((light - dark) / (LIGHT - DARK)).ravel()
    offset = (dark - gain.reshape(dark.shape) * DARK).ravel()
    tables, checks = {}, []
    for name, values, mean, sd in (("gain", gain, 1.0, config.gain_sd), ("offset", offset, 0.0, config.offset_sd)):
        table = spread(values, sd)
        tables[name] = table
        # With no spread at all, the steps of the finest converter remain.
        mean_tolerance = MAX_STANDARD_ERRORS * sd / np.sqrt(len(values)) + 1e-4
        sd_tolerance = MAX_STANDARD_ERRORS * table["sd_error"] + 1e-4
        source = f"configuration, {len(values)} channels"
        checks.append(ValidationCheck(f"mean {name}", table["mean"], mean, mean_tolerance, source))
        checks.append(ValidationCheck(f"standard deviation of {name}", table["sd"], sd, sd_tolerance, source))
    return ExperimentResult(tables, checks, (_gain_panel(gain, config.gain_sd),))


def spread(values: Array, configured_sd: float) -> dict:
    """Return mean and standard deviation of drawn values (N,), and the standard error of the latter if normal."""
    return {
        "values": values,
        "mean": float(values.mean()),
        "sd": float(values.std(ddof=1)),
        "configured_sd": configured_sd,
        "sd_error": configured_sd / float(np.sqrt(2.0 * (len(values) - 1))),
    }


def converter(robot: RobotConfig, seed: int) -> ExperimentResult:
    """Return readings of bare floors with a slowly rising reflectance, by a sensor without spread and noise."""
    config = robot.line_sensor
    quiet = without_faults(config, adc_bits=config.adc_bits)
    bits = min(config.adc_bits, MAX_BITS_SWEPT)
    full, swept = 2**config.adc_bits - 1, 2**bits - 1
    reflectance = np.linspace(0.0, swept / full, POINTS_PER_LEVEL * swept + 1)
    reading = np.array([_on_floor(quiet, level, seed, "converter")[0] for level in reflectance.tolist()])
    levels = np.unique(reading)
    step, largest_error = float(np.diff(levels).max()), float(np.abs(reading - reflectance).max())
    table = {"bits": config.adc_bits, "reflectance": reflectance, "reading": reading}
    scale = "full scale is white: 1 / (2^bits - 1)"
    checks = (
        ValidationCheck("levels", len(levels), swept + 1, 0, f"{config.adc_bits} bits"),
        ValidationCheck("largest step", step, 1.0 / full, ROUNDING / full, scale),
        ValidationCheck("largest error", largest_error, 0.5 / full, ROUNDING / full, "half a step"),
    )
    middle = len(reflectance) // 2
    near = slice(max(0, middle - 2 * ZOOMED_STEPS), middle + 2 * ZOOMED_STEPS + 1)
    origin = np.floor(reflectance[near][0] * full)
    x = np.linspace(reflectance[near][0], reflectance[near][-1], 1001) * full - origin
    curves = (
        Curve(x, np.round(x), "rounded to whole steps", BLUE, width=1),
        Curve(x, x, "without a converter", GREY, ":"),
        Curve(reflectance[near] * full - origin, reading[near] * full - origin, "readings", BLACK, "o", size=4),
    )
    axes = (f"reflectance [steps from {origin:.0f}]", f"reading [steps from {origin:.0f}]")
    panel = Panel(f"Converter of {config.adc_bits} bits: {len(levels)} levels", *axes, curves)
    return ExperimentResult({"sweep": table}, checks, (panel,))


def _on_floor(config: LineSensor, reflectance: float, seed: int, *key: str | int) -> Array:
    """Return the readings (8,) far from any tape."""
    model = sensor(config, Tape(floor_reflectance=reflectance), seed, *key)
    return readings(model, np.array([FAR_M]))[0]


def _gain_panel(gain: Array, configured_sd: float) -> Panel:
    reach = HISTOGRAM_SDS * max(configured_sd, float(gain.std()), 1e-6)
    density, ends = np.histogram(gain, bins=40, range=(1.0 - reach, 1.0 + reach), density=True)
    curves = [Curve(0.5 * (ends[1:] + ends[:-1]), density, "drawn", SKY, kind="bars")]
    if configured_sd > 0.0:
        x = np.linspace(ends[0], ends[-1], 201)
        normal = np.exp(-0.5 * ((x - 1.0) / configured_sd) ** 2) / (configured_sd * np.sqrt(2.0 * np.pi))
        curves.append(Curve(x, normal, "configured", BLACK))
    return Panel(f"Gains of the channels of {ROBOTS} robots", "gain [1]", "density [1]", curves)
