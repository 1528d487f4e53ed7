"""Sentences about single rows of a bench, delays of one row, and effects that are too large for any robot."""

from collections.abc import Iterator, Sequence

import numpy as np

from diagnosis.diagnose import Diagnosis
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.evidence.stuck_rows import StuckRow, stuck_rows
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.naming.named_effect import NamedEffect
from diagnosis.inference.selection.plausible import beyond
from diagnosis.inference.unexplained.leave_one_out import MAX_ROWS, leave_one_out
from diagnosis.measured.measurement import CaseKind, Measurement

ONE_ROW = 0.05
"""Difference of a delay from one row, as a share of it, up to which the order of the columns explains it."""


def row_sentences(diagnosis: Diagnosis) -> Iterator[str]:
    """Yield sentences about rows in which the motor does not turn, and about errors of rows left out of the fit."""
    if diagnosis.measurement.kind is CaseKind.MOTOR_STEADY:
        rows_at_rest = stuck_rows(diagnosis.measurement, diagnosis.nominal)
        for sign in (1.0, -1.0):
            if of_sign := [row for row in rows_at_rest if sign * row.voltage_V > 0.0]:
                yield _stuck(of_sign, diagnosis)
    evidence = diagnosis.evidence
    rows = {len(observed.values) for observed in evidence.observed}
    # With held-out rows there is no need to leave out one row at a time, and long logs would take too long.
    if evidence.heldout.any() or len(rows) != 1 or max(rows) > MAX_ROWS:
        return
    before = _rms(evidence, diagnosis.selection.nominal)
    after = _rms(evidence, diagnosis.fit) if diagnosis.named else {}
    for observed in evidence.observed:
        name, unit = observed.name, observed.unit
        if name in before:
            extended = f", by {after[name]:.3g} {unit} with the effects" if name in after else ""
            yield (
                f"If each row is left out of the fit once, its {name} is wrong by {before[name]:.3g} {unit} (root mean "
                f"square) with the nominal robot and its fitted parameters{extended}."
            )


def too_large(named: NamedEffect) -> list[str]:
    """Return why a named effect is too large to be real; empty if it is not."""
    return [
        f"{excess.parameter} {excess.value:.3g} +- {excess.std:.2g} is beyond {excess.limit:g}, and no such robot is "
        f"known: {excess.why}"
        for excess in beyond(named.effect.kind, named.values, named.std)
    ]


def of_the_log(named: NamedEffect, measurement: Measurement) -> list[str]:
    """Return how the rows of a step log may mislead about a delay or a lag; empty for other effects."""
    if measurement.kind is not CaseKind.MOTOR_STEP:
        return []
    row_s = float(np.median(np.concatenate([np.diff(trial.t_s) for trial in measurement.trials])))
    return [*_of_the_order(named, row_s), *_between_rows(named, measurement, row_s)]


def _of_the_order(named: NamedEffect, row_s: float) -> Iterator[str]:
    """Yield why a delay of the voltage may be the order of the columns."""
    if named.name == "input_delay" and abs(named.values["delay_s"] - row_s) <= ONE_ROW * row_s:
        yield (
            f"the delay is one row of the log, {1e3 * row_s:.3g} ms, as if the voltage of each row were held until the "
            "next row; if the log states it so, the robot has no delay: give u_cmd_V held: after_row in the mapping of "
            "`symolo case init`"
        )


def _between_rows(named: NamedEffect, measurement: Measurement, row_s: float) -> Iterator[str]:
    """Yield the error of a time if the voltage changes at any time between two rows, where it is the larger one.

    The time of each change is then uniform over a row, which has a standard deviation of a row over the root of 12.
    """
    changes = sum(
        int(np.count_nonzero((np.diff(trial["u_cmd_V"].values) != 0.0) & ~trial.holdout[1:]))
        for trial in measurement.trials
    )
    times = [each.name for each in named.effect.coordinates if each.is_time and each.null is not None]
    error_s = row_s / np.sqrt(12.0 * max(changes, 1))
    for name in times:
        if changes and named.std[name] < error_s:
            yield (
                f"the standard error of {name} counts the noise of the readings alone; if the voltage changes at any "
                f"time between two rows of {1e3 * row_s:.3g} ms, and not with the rows, its {changes} changes leave an "
                f"error of about {1e3 * error_s:.2g} ms; in addition, all of them may be stated up to a row late"
            )


def _stuck(rows: Sequence[StuckRow], diagnosis: Diagnosis) -> str:
    """Return what rows at rest with voltages of one sign say of the friction."""
    coulomb = diagnosis.nominal.motor.coulomb_friction_N_m
    strongest = max(rows, key=lambda row: row.holds_N_m)
    volts = sorted({row.voltage_V for row in rows}, key=abs)
    where = f"In row {rows[0].row} the motor does not turn at {volts[0]:g} V"
    speed = f"{rows[0].nominal_speed_rad_s:.3g}"
    if len(rows) > 1:
        ends = f"{volts[0]:g} V" if len(volts) == 1 else f"{volts[0]:g} to {volts[-1]:g} V"
        where = f"In {len(rows)} rows (the first is row {rows[0].row}) the motor does not turn at {ends}"
        speed = f"up to {max(abs(row.nominal_speed_rad_s) for row in rows):.3g}"
    text = (
        f"{where}, but the nominal motor turns at {speed} rad/s: the friction at rest is at least "
        f"{1e3 * strongest.holds_N_m:.3g} mN m, {strongest.holds_N_m / coulomb:.2f} times the nominal dry friction"
    )
    if strongest.moves_N_m is not None:
        text += (
            f", and less than {1e3 * strongest.moves_N_m:.3g} mN m, since the wheel moves at {strongest.moves_at_V:g} V"
        )
    return text + "."


def _rms(evidence: Evidence, fit: HypothesisFit) -> dict[str, float]:
    """Return the root mean square error of rows left out, by quantity, for quantities with usable rows."""
    errors = {name: e[np.isfinite(e)] for name, e in leave_one_out(evidence, fit).items()}
    return {name: float(np.sqrt(np.mean(e**2))) for name, e in errors.items() if len(e)}
