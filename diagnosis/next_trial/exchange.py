"""Search for the best trial: one unit for each slot, by greedy choice and then by exchange of one unit at a time.

A slot is a place in the trial, such as the third row. Slots are filled one after the other with the unit that raises
the criterion most; then the unit of each slot is exchanged for the best one, until no exchange helps (Fedorov, Theory
of Optimal Experiments, 1972, chapter 3, with slots as the coordinates). Nothing is random, so that the same input gives
the same trial.
"""

from collections.abc import Callable, Sequence
from math import ceil

import numpy as np
from numpy.typing import NDArray

from diagnosis.next_trial.separation import Sums, UnitStatistics
from symolo.core.arrays import Array

MIN_SETTINGS = 4
"""Number of different settings of a trial with enough slots."""
MAX_SWEEPS = 8
MIN_RISE = 1e-6
"""Rise of the criterion from which an exchange is made; rounding errors must not decide."""

Criterion = Callable[[Sums], Array]
"""Function from the sums (..., ) of trials to their values (...)."""


def best_units(
    statistics: UnitStatistics, slots: Sequence[NDArray[np.int64]], setting: NDArray[np.int64], criterion: Criterion
) -> NDArray[np.int64]:
    """Return the unit of each slot, (S,), of the best trial.

    Args:
        statistics: Contributions of the units.
        slots: Units from which that of each slot is chosen.
        setting: (U,), number of the setting of each unit, such as that of its voltage. No setting has more than its
            share of the slots: a model that is wrong at one setting would else decide alone.
        criterion: What is to be as large as possible.
    """
    chosen: list[int] = []
    max_slots = ceil(len(slots) / MIN_SETTINGS)
    sums = statistics.of_units.for_units(np.empty(0, dtype=np.int64)).total()
    for slot in slots:
        units = _allowed(slot, chosen, setting, max_slots)
        values = criterion(sums.plus(statistics.of_units.for_units(units)))
        chosen.append(int(units[_best(values)]))
        sums = sums.plus(_single(statistics, chosen[-1]))
    for _ in range(MAX_SWEEPS):
        is_better = False
        for slot, every in enumerate(slots):
            units = _allowed(every, chosen[:slot] + chosen[slot + 1 :], setting, max_slots)
            rest = sums.plus(_single(statistics, chosen[slot]), -1.0)
            values = criterion(rest.plus(statistics.of_units.for_units(units)))
            best = _best(values)
            present = float(values[np.flatnonzero(units == chosen[slot])[0]])
            if float(values[best]) > present + MIN_RISE * max(1.0, abs(present)):
                chosen[slot], is_better = int(units[best]), True
                sums = rest.plus(_single(statistics, chosen[slot]))
        if not is_better:
            break
    return np.array(chosen, dtype=np.int64)


def _allowed(
    units: NDArray[np.int64], others: Sequence[int], setting: NDArray[np.int64], max_slots: int
) -> NDArray[np.int64]:
    """Return the units whose setting does not have its share of the slots yet; all if there are too few settings."""
    count = np.bincount(setting[np.array(others, dtype=np.int64)], minlength=int(setting.max()) + 1)
    allowed = units[count[setting[units]] < max_slots]
    return allowed if len(allowed) else units


def _single(statistics: UnitStatistics, unit: int) -> Sums:
    return statistics.of_units.for_units(np.array([unit])).total()


def _best(values: Array) -> int:
    """Return the first of the largest values, which may differ by rounding errors."""
    return int(np.argmax(values >= values.max() - MIN_RISE * max(1.0, abs(float(values.max())))))
