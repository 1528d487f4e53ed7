"""Whether a motor on a bench turned in a row, as far as its speed reading shows it."""

from dataclasses import dataclass

import numpy as np

from diagnosis.measured.channel import Mask
from symolo.core.arrays import Array

TURNING = 6.0
"""Speed readings in standard deviations of their noise above which a motor turns, of an instrument that does not read
exactly 0 at rest."""


@dataclass(frozen=True)
class SeenMotion:
    """What the speed readings show in each row, (n,) each; nothing in a row that is in none of the three."""

    turns: Mask
    stands: Mask
    is_hidden: Mask
    """Rows with a voltage in which the motor stands still, or turns so slowly that the noise hides it."""

    @property
    def is_seen(self) -> Mask:
        """Whether the row is in one of the three."""
        return self.turns | self.stands | self.is_hidden


def seen_motion(speed_rad_s: Array, sd_rad_s: Array, voltage_V: Array) -> SeenMotion:
    """Return what speeds (n,) show, NaN where none was measured.

    Args:
        speed_rad_s: (n,), measured speeds.
        sd_rad_s: (n,), standard deviation of their noise.
        voltage_V: (n,), voltages.
    """
    none = np.zeros(len(speed_rad_s), dtype=bool)
    if np.any(speed_rad_s == 0.0):
        return SeenMotion(np.isfinite(speed_rad_s) & (speed_rad_s != 0.0), speed_rad_s == 0.0, none)
    turns = speed_rad_s * np.sign(voltage_V) > TURNING * sd_rad_s
    return SeenMotion(turns, none, (np.abs(speed_rad_s) <= TURNING * sd_rad_s) & (np.abs(voltage_V) > 0.0))
