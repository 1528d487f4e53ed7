"""What single rows of a bench say: which stand still, what is missed of each left out; and sizes that no robot has."""

from collections.abc import Iterator

import numpy as np

from diagnosis.diagnose import Diagnosis, Named
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.evidence.stuck_rows import StuckRow, stuck_rows
from diagnosis.inference.fit import Fit
from diagnosis.inference.plausible import beyond
from diagnosis.inference.unexplained.leave_one_out import MAX_ROWS, leave_one_out
from diagnosis.measured.measurement import Kind


def on_rows(diagnosis: Diagnosis) -> Iterator[str]:
    """Sentences about rows that stand still, and about each row left out in turn where none is held out."""
    if diagnosis.measurement.kind is Kind.MOTOR_STEADY:
        yield from (_stuck(row, diagnosis) for row in stuck_rows(diagnosis.measurement, diagnosis.nominal))
    evidence = diagnosis.evidence
    rows = {len(of.values) for of in evidence.observed}
    if evidence.heldout.any() or len(rows) != 1 or max(rows) > MAX_ROWS:
        return
    before = _missed(evidence, diagnosis.selection.nominal)
    after = _missed(evidence, diagnosis.fit) if diagnosis.named else {}
    for of in evidence.observed:
        if of.name not in before:
            continue
        text = (
            f"Each row left out in turn, {of.name} is missed by {before[of.name]:.3g} {of.unit} (root mean square) by"
        )
        text += " the nominal robot with its parameters fitted to the other rows"
        yield text + (f", by {after[of.name]:.3g} {of.unit} with the effects." if of.name in after else ".")


def too_large(named: Named) -> list[str]:
    """Why a named effect is ruled out by its size; empty if it is not."""
    return [
        f"{of.parameter} {of.value:.3g} +- {of.std:.2g} is beyond {of.limit:g}, and no such robot is known: {of.why}"
        for of in beyond(named.effect.kind, named.values, named.std)
    ]


def _stuck(row: StuckRow, diagnosis: Diagnosis) -> str:
    coulomb = diagnosis.nominal.motor.coulomb_friction_N_m
    text = (
        f"Row {row.row} stands still at {row.voltage_V:g} V, where the nominal motor turns at "
        f"{row.nominal_speed_rad_s:.3g} rad/s: friction at rest holds {1e3 * row.holds_N_m:.3g} mN m, "
        f"{row.holds_N_m / coulomb:.2f} times the nominal dry friction"
    )
    if row.moves_N_m is not None:
        text += f", and less than {1e3 * row.moves_N_m:.3g} mN m, with which the wheel moves at {row.moves_at_V:g} V"
    return text + "."


def _missed(evidence: Evidence, fit: Fit) -> dict[str, float]:
    """Root mean square of what is missed, by quantity, where any row is usable."""
    missed = leave_one_out(evidence, fit)
    known = {name: of[np.isfinite(of)] for name, of in missed.items()}
    return {name: float(np.sqrt(np.mean(of**2))) for name, of in known.items() if len(of)}
