"""Whether the wheels of a drive follow a voltage before the row that states it.

The speed of a wheel follows from its last speeds and voltages (an ARX model; Ljung, System Identification, 2nd ed.,
section 4.2). The voltage of the next row adds nothing to that if each voltage is held from its row to the next. If the
controller is faster than the log, a part of the next change has acted already, and that voltage counts, too. A
controller answers to errors of the speed with a voltage of the other sign, which is no such sign.
"""

from collections.abc import Iterator

import numpy as np

from diagnosis.measured.measurement import CHECK, Measurement
from diagnosis.measured.regression import columns_of, regression, without_outliers
from symolo.core.arrays import Array

MIN_ROWS = 60
MIN_PART = 0.04
"""Weight of the next voltage, as a share of those of all voltages, from which it is noted."""
MIN_WHOLE = 0.3
"""Weight of the next voltage, as such a share, from which all of it may act in the row: over a row of 50 ms, a motor
with a time constant of 0.1 s turns about as much by the voltage of this row as by that of the row before."""
MIN_ERRORS = 3.5
"""Weight of the next voltage in standard errors from which it is noted."""
MIN_CHANGE = 1e-3
"""Part of the next voltage that the other columns do not explain, from which its weight is known."""
NEXT, EARLIER_TURN = 3, 5
"""Places of the next voltage and of the turn before the last one in a row of `_equations`."""


def early_response_note(measurement: Measurement) -> Iterator[str]:
    """Yield a note if a wheel follows voltages before they are logged, in part or as a whole."""
    if any(trial.held_inputs for trial in measurement.trials):
        return
    for side in ("left", "right"):
        voltage, ticks = f"u_{side}_V", f"enc_{side}_ticks"
        if not measurement.has(voltage, ticks):
            continue
        rows = np.concatenate([_equations(trial[voltage].values, trial[ticks].values) for trial in measurement.trials])
        rows = rows[np.isfinite(rows).all(axis=1)]
        if not _is_early(rows):
            continue
        if _is_a_row_early(rows):
            yield (
                f"{CHECK} u_left_V and u_right_V: the wheels follow the voltage of the next row, as if each was held "
                "since the row before; in a drive, the voltage of a row is held until the next. If the log states it "
                "so, give both voltages held: before_row in the mapping"
            )
        else:
            yield (
                "the wheels follow the voltages of the next row before it is logged, as with a controller that is "
                "faster than the log: effects of the motors may stay hidden; log the voltages as often as they change"
            )
        return


def _equations(voltage_V: Array, ticks: Array) -> Array:
    """Return the rows (n, 8) of the regression, and the turn that they predict in the last column."""
    turn = np.diff(ticks)
    row = np.arange(2, len(turn) - 1)
    columns = [voltage_V[row], voltage_V[row - 1], voltage_V[row - 2], voltage_V[row + 1], turn[row - 1], turn[row - 2]]
    rows = np.stack([*columns, np.sign(turn[row - 1]), turn[row]], axis=1)
    return rows[turn[row] != 0.0]


def _is_a_row_early(rows: Array) -> bool:
    """Return whether all of each voltage acts before its row, so that none acts in the row after it."""
    # With two earlier turns, a wheel whose voltages all act a row early fits other weights as well.
    without = np.delete(rows, EARLIER_TURN, axis=1)
    weights = np.abs(regression(without)[0][: NEXT + 1])
    shares = weights / weights.sum()
    return bool(shares[NEXT] > MIN_WHOLE and max(shares[1], shares[2]) < MIN_PART)


def _is_early(rows: Array) -> bool:
    """Return whether the next voltage counts in the rows of the regression."""
    if len(rows) < MIN_ROWS:
        return False
    rows = without_outliers(rows)
    if len(rows) < MIN_ROWS:
        return False
    columns = columns_of(rows)
    if not _is_independent(columns):
        return False
    weights, rest = regression(rows)
    inverse = np.linalg.pinv(columns.T @ columns)
    # The noise is larger after a large change (White, Econometrica 48 (1980) 817-838). But if one row alone has a
    # change, it is fitted in any case and does not show its noise.
    white = (inverse @ (columns * rest[:, None] ** 2).T @ columns @ inverse)[NEXT, NEXT]
    variance = max(white, inverse[NEXT, NEXT] * np.mean(rest**2))
    part = weights[NEXT] / np.abs(weights[[0, 1, NEXT]]).sum()
    return bool(part > MIN_PART and weights[NEXT] > MIN_ERRORS * np.sqrt(variance))


def _is_independent(columns: Array) -> bool:
    """Return whether the next voltage is no combination of the other columns, as one that hardly changes is."""
    following, others = columns[:, NEXT], np.delete(columns, NEXT, axis=1)
    rest = following - others @ np.linalg.lstsq(others, following, rcond=None)[0]
    return float(np.linalg.norm(rest)) > MIN_CHANGE * float(np.linalg.norm(following))
