"""The list of units from which a trial is composed: rows of a bench, or runs of a step log."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.measured.measurement import Measurement

Units = NDArray[np.int64]
"""Numbers of units."""


@dataclass(frozen=True, eq=False)
class Library:
    """Units for each slot of a trial."""

    measurement: Measurement
    """All units as trials without readings."""
    setting: Units
    """(U,), number of the setting of each unit: rows at different times may have the same one."""
    is_unit_a_row: bool
    """Whether each row is a unit; else each trial is one."""
    slots: tuple[Units, ...]
    """Units from which that of each slot is chosen."""
    composed: Callable[[Units], Measurement]
    """Function that returns the measurement of chosen units, one for each slot (S,)."""
    ordered: Callable[[Units], Units]
    """Function that returns the same choice (S,) in an order that is easy to do."""
    titles: tuple[str, ...] = ()
    """Description of each unit that is a trial; empty if the inputs of a row describe it."""

    @property
    def units(self) -> int:
        """Number of units, U."""
        return len(self.setting)

    def unit_of(self, trial: Units) -> Units:
        """Return the unit of each sample from its trial, (n,) each."""
        return np.arange(len(trial)) if self.is_unit_a_row else trial
