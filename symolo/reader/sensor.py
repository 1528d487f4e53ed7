"""A sensor of `robot.sensors` in one run: its kind, its place on the robot and its samples."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from symolo.core.arrays import Array
from symolo.core.geometry.poses import mounted
from symolo.core.progress import plural
from symolo.dataset.codes import TofStatus
from symolo.dataset.documents.run_document import SensorSection
from symolo.dataset.tables.side_tables import SideTable
from symolo.reader.tables import frame


@dataclass(frozen=True)
class RunSensor:
    """A sensor of `robot.sensors` in one run."""

    name: str
    settings: SensorSection
    """Settings of the sensor in this run, as side/spec.json has them."""
    side_table: SideTable
    numbers: Array
    """(samples, columns) of the file, the time [ms] first."""

    def __repr__(self) -> str:
        columns = ", ".join(f"{column.title} [{column.unit}]" for column in self.side_table.columns)
        return f"RunSensor({self.name!r}, kind {self.kind!r}, {plural(len(self.numbers), 'sample')} of {columns})"

    @property
    def kind(self) -> str:
        return self.settings.kind or self.name

    @property
    def t_s(self) -> Array:
        """(samples,), time of each sample since the start of the run [s]."""
        return self.numbers[:, 0] / 1000

    @cached_property
    def X_RS(self) -> Array:
        """(4, 4), pose in R of the sensor's frame S: x forward, y left, z up. A kind without a place has that of R."""
        one = self.settings
        return mounted((one.x_m, one.y_m, one.z_m), *np.radians([one.yaw_deg, one.pitch_up_deg, one.roll_deg]))

    @property
    def samples(self) -> pd.DataFrame:
        """Samples with the columns of the file; `attrs["units"]` names the units."""
        return frame(self.side_table.cells, self.numbers)

    def has(self, column: str) -> bool:
        """Return whether the table has a column, or a numbered group of columns, of this name."""
        return any(one.name == column for one in self.side_table.columns)

    def values(self, column: str) -> Array:
        """Return the values of a column (samples,), or those of a numbered group of columns (samples, count).

        Raises:
            KeyError: The table has no such column.
        """
        first = 0
        for one in self.side_table.columns:
            if one.name == column:
                values = self.numbers[:, first : first + one.count]
                return values if one.count > 1 else values[:, 0]
            first += one.count
        raise KeyError(f"no column {column!r}; there are {', '.join(one.name for one in self.side_table.columns)}")

    @property
    def no_target(self) -> NDArray[np.bool_]:
        """(samples,), or (samples, rays) of a lidar: whether a range sensor saw nothing.

        Raises:
            KeyError: The sensor has no ranges.
        """
        if self.kind == "vl53l0x":
            return self.values("status") == TofStatus.NO_TARGET
        missed = self.values("range") == 0
        return missed.reshape(len(missed), -1) if self.kind == "lidar" else missed

    def delivered(self, t_s: Array) -> NDArray[np.intp]:
        """Return the index (N,) of the newest sample that was delivered by each of these times (N,).

        Before the first delivery it is that of the first sample.
        """
        newest = np.searchsorted(self.t_s + self.settings.delay_s, t_s + 1e-9, side="right") - 1
        return np.maximum(newest, 0)
