"""Whether the motor of a step log follows the voltage of a neighbouring row in place of that of its own row.

In a step log, the voltage of a row was held since the row before. A loop that reads its sensors, sets a new voltage and
prints both writes the voltage that is held until the next row. Speed and current follow from their last value and the
voltages (an ARX model; Ljung, System Identification, 2nd ed., section 4.2), so that the weights of the voltages show
which row they belong to.
"""

from collections.abc import Iterator

import numpy as np

from diagnosis.measured.measurement import CHECK, Measurement
from diagnosis.measured.regression import columns_of, regression, without_outliers
from symolo.core.arrays import Array

LAGS = (-1, 0, 1, 2, 3)
"""Rows by which the voltages of the regression are older than the reading that they predict."""
MIN_ROWS = 60
OTHER_ROWS = 0.04
"""Largest weight of a voltage before the first that acts, as a share of those of all voltages."""
MIN_SHARE = {"omega_rad_s": 0.9, "current_A": 0.4}
"""Smallest weight of the first voltage that acts: all of it for a speed, and half of it for a current, which then falls
while the motor speeds up."""
MIN_ERRORS = 10.0
"""Smallest weight of the first voltage that acts, in standard errors."""


def voltage_row_checks(measurement: Measurement) -> Iterator[str]:
    """Yield a note if both logged readings of a step log follow the voltage of the row before or after their own."""
    lags = [_lag(measurement, name) for name in MIN_SHARE if measurement.has("u_cmd_V", name)]
    step_ms = 1e3 * float(np.median(np.concatenate([np.diff(trial.t_s) for trial in measurement.trials])))
    if lags and all(lag == 1 for lag in lags):
        yield (
            f"{CHECK} u_cmd_V: the motor follows the voltage of the row before, as if each were held from its row to "
            "the next; in a step log, the voltage of a row was held since the row before. If the log states it so, "
            f"give u_cmd_V held: after_row in the mapping; otherwise the voltage acts a row, {step_ms:.3g} ms, late"
        )
    if lags and all(lag == -1 for lag in lags):
        yield (
            f"{CHECK} u_cmd_V: the motor follows the voltage of the next row, before it can know it; the times of the "
            f"voltages, or those of the readings, are wrong by a row, {step_ms:.3g} ms; give the readings "
            f"time_offset_s: {1e-3 * step_ms:.3g} in the mapping"
        )


def _lag(measurement: Measurement, name: str) -> int | None:
    """Return by how many rows the voltage is older that a reading follows; None if no single row stands out."""
    rows = np.concatenate([_equations(trial["u_cmd_V"].values, trial[name].values) for trial in measurement.trials])
    rows = rows[np.isfinite(rows).all(axis=1) & (rows[:, -1] != 0.0)]
    if len(rows) < MIN_ROWS:
        return None
    rows = without_outliers(rows)
    if len(rows) < MIN_ROWS:
        return None
    weights, rest = regression(rows)
    inverse = np.linalg.pinv(columns_of(rows).T @ columns_of(rows))
    errors = np.sqrt(np.diag(inverse)[: len(LAGS)] * np.mean(rest**2))
    lag_weights = weights[: len(LAGS)]
    shares = lag_weights / np.abs(lag_weights).sum()
    first = int(np.argmax(np.abs(shares) > OTHER_ROWS))
    is_clear = shares[first] >= MIN_SHARE[name] and lag_weights[first] > MIN_ERRORS * errors[first]
    return LAGS[first] if is_clear else None


def _equations(voltage_V: Array, reading: Array) -> Array:
    """Return the rows (n, 8) of the regression, with the reading that they predict in the last column."""
    row = np.arange(max(LAGS), len(reading) + min(LAGS))
    before = reading[row - 1]
    return np.stack([*(voltage_V[row - lag] for lag in LAGS), before, np.sign(before), reading[row]], axis=1)
