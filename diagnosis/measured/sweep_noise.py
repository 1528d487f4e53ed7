"""The noise of the readings of a motor in steady states, whose rows are no time series.

Readings at the same voltage differ by noise alone (`noise.noise_of_repeats`). Without repeats there is the curve: while
the motor turns, current and speed are nearly straight lines over the voltage, and a reading differs from the straight
line through its two neighbours by the noise of all three. What bends within two neighbours counts as noise.
"""

from math import sqrt

import numpy as np

from diagnosis.measured.measurement import Measurement
from diagnosis.measured.noise import MIN_ROWS, Noise, noise_of_repeats, trimmed_variance
from diagnosis.measured.screening import usable
from symolo.core.arrays import Array


def noise_of_equal_voltages(measurement: Measurement, name: str) -> Noise | None:
    """Return the noise of readings at the same voltage in several sweeps; None below 8 degrees of freedom."""
    values = np.concatenate([usable(channel) for channel in measurement.across(name)])
    conditions = [
        (trial.part, voltage) for trial in measurement.trials for voltage in trial["u_cmd_V"].values.round(6).tolist()
    ]
    return noise_of_repeats(values, conditions)


def noise_of_sweeps(measurement: Measurement, name: str) -> Noise | None:
    """Return the noise of a channel by repeats or, without them, by the curve over the voltage; None with few rows."""
    repeated = noise_of_equal_voltages(measurement, name)
    if repeated is not None:
        return repeated
    parts = [
        _off_neighbours(trial["u_cmd_V"].values, usable(trial[name]), usable(trial["omega_rad_s"]))
        for trial in measurement.trials
    ]
    deviates = np.concatenate(parts)
    if len(deviates) < MIN_ROWS:
        return None
    return Noise(sqrt(trimmed_variance(deviates)), 0.0, len(deviates))


def _off_neighbours(voltage: Array, values: Array, speed: Array) -> Array:
    """Return deviations from the lines through both neighbours, scaled to the variance of one reading.

    Only rows that turn in the same direction are neighbours. Rows with the same voltage are one row, their mean.
    """
    deviates = []
    for sign in (-1.0, 1.0):
        turns = np.isfinite(values) & (np.sign(voltage) == sign) & (sign * speed > 0.05 * np.nanmax(np.abs(speed)))
        u, place, rows = np.unique(voltage[turns], return_inverse=True, return_counts=True)
        if len(u) < 3:
            continue
        mean = np.bincount(place, weights=values[turns]) / rows
        ahead = (u[1:-1] - u[:-2]) / (u[2:] - u[:-2])
        off = mean[1:-1] - (1.0 - ahead) * mean[:-2] - ahead * mean[2:]
        variance = 1.0 / rows[1:-1] + (1.0 - ahead) ** 2 / rows[:-2] + ahead**2 / rows[2:]
        deviates.append(off / np.sqrt(variance))
    return np.concatenate(deviates) if deviates else np.empty(0)
