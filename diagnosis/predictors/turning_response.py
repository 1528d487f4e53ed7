"""Response of a quantity to a small torque that depends on the angle of a shaft, without a simulation."""

from dataclasses import dataclass
from math import exp

import numpy as np
from numpy.typing import NDArray

from diagnosis.measured.channel import Mask
from symolo.core.arrays import Array


@dataclass(frozen=True)
class TurningResponse:
    """First-order response to a torque against the motion, in n rows of one or several trials.

    While the shaft turns, the response of a row is that of the row before times `kept`, plus `scale` (1 - `kept`) times
    the torque in the row.
    """

    angle_rad: Array
    """(n,), angle of the shaft in the middle of each row, since the start of its trial."""
    turned_rad: Array
    """(n,), angle by which the shaft turns in each row; 0 at rest."""
    trial: NDArray[np.int64]
    """(n,), trial of each row."""
    scale: float
    """Change of the quantity by a constant torque of 1 N m."""
    time_constant_s: float
    period_s: float
    """Duration of a row."""

    @property
    def remaining_share(self) -> float:
        """Share of a response that is left a row later."""
        return exp(-self.period_s / self.time_constant_s)

    @property
    def is_turning(self) -> Mask:
        return self.turned_rad != 0.0

    def forces(self, weighted: Array) -> Array:
        """Return the numbers (n,) whose sum of products with any torques is that of `weighted` (n,) with the responses.

        This is the transpose of the response, which runs backwards through each trial.
        """
        after = np.zeros_like(weighted)
        for trial in np.unique(self.trial):
            rows = self.trial == trial
            after[rows] = _decaying_sums(weighted[rows][::-1], self.remaining_share)[::-1]
        return np.where(self.is_turning, self.scale * (1.0 - self.remaining_share) * after, 0.0)

    def squares(self, cycles_per_turn: Array) -> Array:
        """Return the squares (F, n) of the settled responses to torques of 1 N m that vary with the angle.

        Args:
            cycles_per_turn: (F,), cycles of the torque in a turn.
        """
        phase = cycles_per_turn[:, None] * np.abs(self.turned_rad)
        gain = self.scale * (1.0 - self.remaining_share)
        return np.where(
            self.is_turning, gain**2 / (1.0 + self.remaining_share**2 - 2.0 * self.remaining_share * np.cos(phase)), 0.0
        )


def _decaying_sums(values: Array, decay: float) -> Array:
    """Return the sums (n,) of each value, those before it times `decay`, those before them times its square, and so on.

    Each pass doubles the number of values in a sum. `scipy.signal.lfilter` does the same, but takes a second to load.
    """
    sums, reach = values.copy(), 1
    while reach < len(sums) and decay > 0.0:
        sums[reach:] = sums[reach:] + decay * sums[:-reach]
        reach, decay = 2 * reach, decay**2
    return sums
