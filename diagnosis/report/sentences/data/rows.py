"""Sentences about single rows of a bench: those in which the motor stands still, and those left out of the fit."""

from collections.abc import Iterator, Sequence

import numpy as np

from diagnosis.diagnose import Diagnosis
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.evidence.stuck_rows import StuckRow, stuck_rows
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.unexplained.leave_one_out import MAX_ROWS, leave_one_out
from diagnosis.measured.measurement import CaseKind


def row_sentences(diagnosis: Diagnosis) -> Iterator[str]:
    """Yield sentences about rows in which the motor does not turn, and about errors of rows left out of the fit."""
    if diagnosis.measurement.kind is CaseKind.MOTOR_STEADY:
        rows_at_rest = stuck_rows(diagnosis.measurement, diagnosis.nominal)
        for sign in (1.0, -1.0):
            if rows_of_sign := [row for row in rows_at_rest if sign * row.voltage_V > 0.0]:
                yield _stuck(rows_of_sign, diagnosis)
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
