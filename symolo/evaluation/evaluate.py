"""The errors of an estimated trajectory in a run."""

from dataclasses import dataclass

import numpy as np

from symolo.core.arrays import Array
from symolo.core.errors import InputError, nearest
from symolo.evaluation.align import Align
from symolo.evaluation.alignment import Movement, alignment
from symolo.evaluation.association import MAX_GAP_S, associated
from symolo.evaluation.errors import Errors, errors_of
from symolo.evaluation.estimate import Estimate, EstimatedTrajectory
from symolo.evaluation.suspicions import check_units, suspicions
from symolo.evaluation.variance_units import variance_suspicions
from symolo.reader.run import Run


@dataclass(frozen=True)
class Evaluation:
    """An estimate at the rows of a run, and its errors."""

    estimate: Estimate
    """Estimates that have a row of data.csv, after the alignment."""
    errors: Errors
    movement: Movement
    """The movement of the alignment; no turn and no shift without one."""
    warnings: tuple[str, ...]
    """What is suspicious about the estimates, in one sentence each."""


def evaluate(
    run: Run, trajectory: EstimatedTrajectory, *, align: Align | str = Align.NONE, max_gap_s: float = MAX_GAP_S
) -> Evaluation:
    """Return the errors of estimates against the true poses of a run.

    Args:
        run: The run in which the estimates were made.
        trajectory: Estimated poses of the robot in W at times since the first row of data.csv.
        align: `none` leaves the poses as they are; `se2` turns and shifts them so that their places agree best with the
            true ones; `start` moves the first pose to the true one.
        max_gap_s: Largest time between an estimate and the row of data.csv with which it is compared.

    Raises:
        InputError: No estimate has a row, or their times, places or headings are likely in other units.
    """
    return evaluate_against(run.t_s, run.table.pose, trajectory, align=align, max_gap_s=max_gap_s)


def evaluate_against(
    t_s: Array,
    truth: Array,
    trajectory: EstimatedTrajectory,
    *,
    align: Align | str = Align.NONE,
    max_gap_s: float = MAX_GAP_S,
) -> Evaluation:
    """Return the errors of estimates against true poses (N, 3) at the times (N,); otherwise as `evaluate`.

    Raises:
        InputError: As `evaluate`.
    """
    if not max_gap_s >= 0.0 or not np.isfinite(max_gap_s):
        raise InputError("max_gap_s", got=max_gap_s, allowed="a time in s, 0 or more")
    names = [choice.value for choice in Align]
    if align not in names:
        raise InputError("align", got=align, allowed=", ".join(names), nearest=nearest(align, names))
    associated_estimate = associated(trajectory, t_s, max_gap_s)
    check_units(associated_estimate, truth)
    movement = alignment(Align(align), associated_estimate, truth)
    estimate = movement.applied(associated_estimate)
    warnings: tuple[str, ...] = ()
    if align == Align.NONE:
        warnings = (*suspicions(estimate, t_s, truth), *variance_suspicions(estimate, truth))
    return Evaluation(estimate, errors_of(estimate, t_s, truth), movement, warnings)
