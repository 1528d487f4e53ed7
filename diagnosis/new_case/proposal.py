"""Proposal of a mapping for the log of a case whose kind follows from its columns."""

from diagnosis.measured.measurement import CaseKind
from diagnosis.new_case.quantities import KINDS, of_wheels
from logs.log_file import LogFile
from logs.mapping import MAPPING, Source
from logs.proposal import Proposal, missing, propose_as, time_step_s
from logs.quantity import SIDES
from logs.units import taken_apart
from symolo.core.errors import InputError

STEADY_FROM_S = 0.25
"""Time between two rows from which a log of a motor has one steady state in each row."""

USUAL_NAMES = "time_ms, pwm, voltage [V], current_mA, rpm, encL, x [mm], heading_deg, range_cm"
"""Names of columns in logs of others, one for each quantity that most logs have."""


def propose(log: LogFile, kind: CaseKind | None = None, supply_V: float | None = None) -> Proposal:
    """Return a mapping for the log of a case.

    Args:
        log: The log.
        kind: Kind of the case; recognised from the columns by default.
        supply_V: Voltage of a duty cycle of 1, if it is known.

    Raises:
        InputError: The columns of no kind, or not those of this one, are in the log.
    """
    if kind in {None, CaseKind.DRIVE_LOG}:
        _check_wheels(log)
    proposal = propose_as(log, KINDS[kind or _kind(log)], supply_V)
    front = proposal.mapping.columns.get("tof_front_m", Source()).column
    if front in {"", "tof_front_m"} or SIDES & set(taken_apart(front).words):
        return proposal
    guess = f"{front} (tof_front_m): taken for the sensor in front; else rename it in {MAPPING}"
    return Proposal(proposal.mapping, (*proposal.warnings, guess))


def _check_wheels(log: LogFile) -> None:
    """Refuse a log of a robot with more than two driven wheels.

    Raises:
        InputError: More than two columns are counts of encoders.
    """
    wheels = of_wheels(list(log.columns))
    if len(wheels) > 2:
        raise InputError(
            f"counts of {len(wheels)} wheels: {', '.join(wheels)}",
            where=log.header_where,
            allowed="one left and one right wheel on a common axle, which is all that the simulator can drive",
            cure="a robot with three omnidirectional wheels cannot be compared; if two of the wheels are such a pair, "
            f"or each side has several wheels on one motor, write a {MAPPING} (docs/case_from_log.md) with one column "
            "for each side, and name it with --mapping",
        )


def _kind(log: LogFile) -> CaseKind:
    """Return the kind whose needs the columns meet, and most of whose quantities they hold."""
    columns_of_kind = {kind: KINDS[kind].matched(list(log.columns)) for kind in KINDS}
    fitting = [kind for kind in KINDS if KINDS[kind].suffices(columns_of_kind[kind])]
    closest = max(KINDS, key=lambda kind: len(columns_of_kind[kind]))
    if not fitting and len(columns_of_kind[closest]) > 1:
        raise missing(log, KINDS[closest], columns_of_kind[closest])
    if not fitting:
        line = f'`t_s: {{column: "{next(iter(log.columns))}"}}`'
        raise InputError(
            "cannot recognise what was logged from the names of the columns",
            where=log.header_where,
            got=list(log.columns),
            allowed="; ".join(f"for {kind}: {' '.join(sorted(KINDS[kind].needed[0]))}" for kind in KINDS),
            cure=f"rename the columns (usual names such as {USUAL_NAMES} are recognised, too), or write a {MAPPING}"
            f" with lines such as {line} (docs/case_from_log.md#correct-the-mapping) and name it with --mapping",
        )
    best = max(fitting, key=lambda kind: len(columns_of_kind[kind]))
    if best in {CaseKind.MOTOR_STEP, CaseKind.MOTOR_STEADY}:
        return (
            CaseKind.MOTOR_STEP
            if _is_fast(log, columns_of_kind[CaseKind.MOTOR_STEP].get("t_s", ""))
            else CaseKind.MOTOR_STEADY
        )
    return best


def _is_fast(log: LogFile, column: str) -> bool:
    """Return whether the rows of a motor's log are samples against time, rather than steady states."""
    return bool(column) and time_step_s(log, column) < STEADY_FROM_S
