"""Columns of logs in other units or under other names than ours, and the channels that they become."""

from dataclasses import dataclass

import numpy as np

from diagnosis.measured.case_files.csv_table import MeasuredColumn
from diagnosis.measured.channel import Channel
from symolo.core.arrays import Array
from symolo.core.tables.table import CsvTable
from symolo.core.tables.time_series import TimeSeries


@dataclass(frozen=True, kw_only=True)
class LogColumn(MeasuredColumn):
    """A column of a log; its unit and reach are those of the log."""

    channel: str
    """Name of the channel that the column becomes."""
    channel_unit: str
    factor: float = 1.0
    """Value of the channel for a value of 1 in the log."""
    is_wrapped: bool = False
    """Whether the values are angles that are wrapped to one turn, while the channel continues beyond it."""
    clock: str = "log"
    """Name of the clock of the channel."""

    def read(self, table: CsvTable, t_s: Array) -> Channel:
        """Return the column of a table as a channel with these times (N,)."""
        values = self.factor * table.numbers[self.name]
        if self.is_wrapped:
            known = np.isfinite(values)
            values[known] = np.unwrap(values[known])  # a NaN would make all later angles NaN
        return Channel.logged(TimeSeries(self.channel, self.channel_unit, t_s, values), self.role, clock=self.clock)
