"""Units of a bench: each row has one of a list of settings."""

from collections.abc import Callable

import numpy as np

from diagnosis.measured.measurement import Measurement, Trial
from diagnosis.next_trial.library.base import Library, Units
from diagnosis.next_trial.template import measurement_of
from symolo.core.arrays import Array


def library_of_rows(
    template: Measurement,
    settings: int,
    t_s: Array,
    trial: Callable[[str, Units], Trial],
    order: Callable[[Units], Units],
) -> Library:
    """Return a unit for each setting at each time.

    Args:
        template: The old data.
        settings: Number of settings.
        t_s: (N,), times of the rows [s].
        trial: Function that returns the trial with a name and the numbers of the settings of its rows (N,).
        order: Function that returns numbers of settings in an order that is easy to do.
    """
    rows = len(t_s)

    def composed(units: Units) -> Measurement:
        return measurement_of(template, [trial("1", units // rows)])

    def ordered(units: Units) -> Units:
        return order(units // rows) * rows + np.arange(rows)

    return Library(
        measurement_of(template, [trial(str(k + 1), np.full(rows, k)) for k in range(settings)]),
        np.arange(settings * rows) // rows,
        is_unit_a_row=True,
        slots=tuple(np.arange(settings) * rows + slot for slot in range(rows)),
        composed=composed,
        ordered=ordered,
    )
