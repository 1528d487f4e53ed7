"""Doubts about a named effect: sizes that no robot has, and delays that the rows of the log may cause."""

from collections.abc import Iterator

import numpy as np

from diagnosis.inference.naming.named_effect import NamedEffect
from diagnosis.inference.selection.plausible import beyond
from diagnosis.measured.measurement import CaseKind, Measurement
from diagnosis.report.sentences.quantities import listed, percent

NOTABLE = 0.02
"""Weight of a size beside a second effect from which it is stated."""
ONE_ROW = 0.05
"""Difference of a delay from one row, as a share of it, up to which the order of the columns explains it."""


def size_doubts(named: NamedEffect) -> list[str]:
    """Return why a named effect is too large to be real; empty if it is not."""
    return [
        f"{excess.parameter} {excess.value:.3g} +- {excess.std:.2g} is beyond {excess.limit:g}, and no such robot is "
        f"known: {excess.why}"
        for excess in beyond(named.effect.kind, named.values, named.std)
    ]


def log_doubts(named: NamedEffect, measurement: Measurement) -> list[str]:
    """Return how these data may mislead about the numbers of a named effect; empty if they may not.

    In a step log, that is how the rows may mislead about a delay or a lag.
    """
    if measurement.kind is not CaseKind.MOTOR_STEP:
        return [*_other_sizes(named)]
    row_s = float(np.median(np.concatenate([np.diff(trial.t_s) for trial in measurement.trials])))
    return [*_other_sizes(named), *_order_doubts(named, row_s), *_time_doubts(named, measurement, row_s)]


def _other_sizes(named: NamedEffect) -> Iterator[str]:
    """Yield the size beside a second effect that is not certain, if its weight matters."""
    other = named.other_size
    if other is not None and other.weight >= NOTABLE:
        numbers = listed([f"{name} {named.values[name] + change:.3g}" for name, change in other.changes.items()])
        yield (
            f"beside {other.beside}, which these data only hint at, it would be {numbers}; the standard errors include "
            f"this with a weight of {percent(other.weight)}, the profile intervals do not"
        )


def _order_doubts(named: NamedEffect, row_s: float) -> Iterator[str]:
    """Yield why a delay of the voltage may be the order of the columns."""
    if named.name == "input_delay" and abs(named.values["delay_s"] - row_s) <= ONE_ROW * row_s:
        yield (
            f"the delay is one row of the log, {1e3 * row_s:.3g} ms, as if the voltage of each row were held until the "
            "next row; if the log states it so, the robot has no delay: give u_cmd_V held: after_row in the mapping of "
            "`symolo case init`"
        )


def _time_doubts(named: NamedEffect, measurement: Measurement, row_s: float) -> Iterator[str]:
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
