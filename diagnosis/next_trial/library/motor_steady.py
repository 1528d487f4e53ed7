"""Rows of a motor bench: a voltage for each row, held until the motor runs steadily."""

from collections.abc import Sequence

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.measured.measurement import CaseKind, Measurement, Trial
from diagnosis.next_trial.library.base import Library, Units
from diagnosis.next_trial.library.rows import library_of_rows
from diagnosis.next_trial.limits import Limits
from diagnosis.next_trial.template import measurement_of, trial_with
from diagnosis.predictors import STAGES
from symolo.core.arrays import Array
from symolo.core.errors import InputError

LEVELS = 24
"""Number of evenly spaced voltages of one direction."""
BELOW, ABOVE = (0.25, 0.5, 0.72), (1.4, 1.7, 2.2, 3.0)
"""Further voltages, relative to that at which the motor starts: a motor that stands shows its resistance alone, and one
that turns slowly its friction."""
PROBES, MIN_PROBE = 120, 1e-3
"""Number of the voltages that are tried to find where the motor starts, and the smallest, relative to the highest."""
CLEAR = 1.33
"""Ratio of a voltage to that at which a motor starts, and of the latter to the former, from which it is certain whether
the motor turns."""


def motor_steady(template: Measurement, limits: Limits, robots: Sequence[RobotConfig]) -> Library:
    """Return the rows for the limits; `robots` are those of the remaining models.

    Raises:
        InputError: The motor does not turn within the limits.
    """
    levels_V = _levels(template, limits, robots)
    t_s = limits.row_s * np.arange(1.0, limits.units + 1.0)

    def trial(name: str, levels: Units) -> Trial:
        return trial_with(template, name, t_s.copy(), {"u_cmd_V": levels_V[levels]})

    def order(levels: Units) -> Units:
        # Forward from low to high voltages, then backward, so that the supply is reversed once.
        return levels[np.lexsort((np.abs(levels_V[levels]), levels_V[levels] < 0.0))]

    return library_of_rows(template, len(levels_V), t_s, trial, order)


def _levels(template: Measurement, limits: Limits, robots: Sequence[RobotConfig]) -> Array:
    """Return the voltages at which all models agree on whether the motor turns."""
    signs = (_direction(template),) if limits.one_direction else (1.0, -1.0)
    return np.concatenate([sign * _sizes(template, limits.max_voltage_V, sign, robots) for sign in signs])


def _sizes(template: Measurement, max_V: float, sign: float, robots: Sequence[RobotConfig]) -> Array:
    """Return the sizes of the voltages of one direction, with some below and above those at which the motor starts."""
    probes_V = max_V * np.geomspace(MIN_PROBE, 1.0, PROBES)
    trial = trial_with(template, "1", np.arange(1.0, PROBES + 1.0), {"u_cmd_V": sign * probes_V})
    (stage,) = STAGES[CaseKind.MOTOR_STEADY](measurement_of(template, [trial]), robots[0])
    turns = stage.predict(robots)[1].mean != 0.0
    if not turns.any():
        cure = "allow a higher voltage with --max-voltage"
        raise InputError(f"the motor does not turn at up to {max_V:g} V", got="this limit", cure=cure)
    starts_V = np.where(turns.all(axis=0), probes_V, np.inf).min()
    stands_V = np.where(turns.any(axis=0), probes_V, np.inf).min()
    above_V = starts_V * np.array(ABOVE) if np.isfinite(starts_V) else np.empty(0)
    sizes_V = np.concatenate([max_V * np.arange(1, LEVELS + 1) / LEVELS, stands_V * np.array(BELOW), above_V])
    sizes_V = np.unique([min(float(f"{size:.2g}"), max_V) for size in sizes_V[sizes_V <= max_V].tolist()])
    return sizes_V[(sizes_V * CLEAR <= stands_V) | (sizes_V >= CLEAR * starts_V)]


def _direction(template: Measurement) -> float:
    """Return the sign of most voltages of the old data."""
    voltage_V = np.concatenate([channel.values for channel in template.across("u_cmd_V")])
    return -1.0 if np.nansum(np.sign(voltage_V)) < 0.0 else 1.0
