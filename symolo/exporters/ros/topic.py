"""A topic of a ROS bag, and the tables of a run that its messages are made from."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd

from symolo.exporters.ros.vocabulary import START_NS, Planar, Vocabulary
from symolo.reader.run import Run

Stamped = tuple[int, Any]
"""Time in the bag [ns] and message."""


@dataclass(frozen=True)
class Log:
    """Tables of a run, read once for all topics."""

    run: Run

    @cached_property
    def at_ns(self) -> list[int]:
        """Stamp [ns] of each row."""
        return [START_NS + t_ms * 1_000_000 for t_ms in self.run.table.t_ms.tolist()]

    @cached_property
    def wheels(self) -> pd.DataFrame:
        return self.run.side("wheels")

    @cached_property
    def odometry(self) -> list[Planar]:
        return self.wheels[["odometry_x", "odometry_y", "odometry_theta"]].to_numpy().tolist()

    def rows(self, *columns: np.ndarray) -> Iterator[tuple[int, int, Any]]:
        """Yield number, stamp [ns] and values of each row."""
        values = zip(*(one.tolist() for one in columns), strict=True)
        return zip(range(len(self.at_ns)), self.at_ns, values, strict=True)


@dataclass(frozen=True)
class Topic:
    """A topic of a bag."""

    name: str
    type: str
    messages: Callable[[Log, Vocabulary], Iterator[Stamped]]
    """Function that yields the messages in the order of time."""
    latched: bool = False
    """Whether a late subscriber gets the last message."""
