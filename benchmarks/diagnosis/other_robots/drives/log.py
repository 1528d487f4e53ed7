"""What is logged in a case."""

from dataclasses import dataclass, field

import numpy as np

from benchmarks.diagnosis.other_robots.draws import Array


@dataclass
class Log:
    """Everything logged in a case (rows last), and which readings are good."""

    trial: Array
    session: Array
    t: Array
    commands: Array
    u: Array
    ticks: Array
    pose: Array
    """(rows, 3)"""
    ranges: Array
    starts: list[int]
    ends: list[int]
    good_pose: Array = field(default_factory=lambda: np.zeros(0))
    good_ranges: Array = field(default_factory=lambda: np.zeros(0))
    good_ticks: Array = field(default_factory=lambda: np.zeros(0))

    def rows(self, q: int) -> slice:
        """Return the rows of a trial."""
        return slice(self.starts[q], self.ends[q])

    def delayed(self, signal: Array, delay: Array) -> Array:
        """Return a signal (rows by columns) as it was some seconds ago, trial by trial."""
        out = np.array(signal, float)
        for q in range(len(self.starts)):
            rows = self.rows(q)
            for c in range(out.shape[1]):
                out[rows, c] = np.interp(self.t[rows] - delay[rows], self.t[rows], signal[rows, c])
        return out
