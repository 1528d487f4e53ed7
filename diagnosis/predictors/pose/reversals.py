"""Reversals of a drive: where the robot starts to turn the other way, or to drive the other way.

What happens then depends on the motion before: a caster swings round, play in a gear is taken up, a twisted tyre
springs back. No effect of the list has such a memory, and no function of the present motion describes it. Any
hysteresis is a sum of relays (Preisach, Z. Phys. 94 (1935) 277-302): a relay switches when the rate has exceeded a
threshold in the other direction. So the switchings of a few relays are covariates of the change of the pose. They
follow from the counts alone.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from configs.schema.robot import RobotConfig
from diagnosis.measured.case_files.nominal import NominalLog
from diagnosis.measured.measurement import Measurement
from diagnosis.predictors.base import Covariate, CovariateShape
from symolo.core.arrays import Array

THRESHOLDS = (0.01, 0.02, 0.04, 0.08, 0.16, 0.32)
"""Thresholds of the relays, as shares of a rate that is exceeded in one row of a hundred."""
LARGEST = 0.99
ROUNDING_COUNTS = 2.0
"""Counts by which rounding changes the difference of the wheels' counts in a row at most: one for each wheel."""
SIGMAS = 3.0
"""Noise of logged speeds, in standard deviations, that switches no relay."""


@dataclass(frozen=True)
class BodyRate:
    """How fast the body drives or turns by the counts."""

    values: Array
    """(n,), mean rate since the row before [m/s or rad/s]; that of the first row of a trial is of no interest."""
    floor: float
    """Rate that rounded counts or the noise of logged speeds reach."""


def body_rates(
    measurement: Measurement, counts: Array, steps_s: Array, nominal: RobotConfig
) -> tuple[BodyRate, BodyRate]:
    """Return the rates of turning and of driving.

    Args:
        measurement: The log.
        counts: (n, 2), counts of the right and the left wheel.
        steps_s: (n,), time since the row before.
        nominal: The nominal robot.
    """
    m_per_count = pi * nominal.drive.wheel_diameter_m / nominal.encoder.counts_per_revolution
    right, left = m_per_count * np.diff(counts, axis=0, prepend=counts[:1]).T / steps_s
    rounding_m_s = ROUNDING_COUNTS * m_per_count / float(np.median(steps_s))
    noise = measurement.nominal.noise if isinstance(measurement.nominal, NominalLog) else None
    # A rate that rounding or noise alone exceeds would switch with the error of the prediction.
    turn_floor = max(rounding_m_s / nominal.drive.track_m, SIGMAS * noise.w_rad_s if noise else 0.0)
    travel_floor = max(0.5 * rounding_m_s, SIGMAS * noise.v_m_s if noise else 0.0)
    turn = BodyRate((right - left) / nominal.drive.track_m, turn_floor)
    return turn, BodyRate(0.5 * (right + left), travel_floor)


def reversal_covariates(
    rates: tuple[BodyRate, BodyRate], trials: Sequence[int], windows: tuple[NDArray[np.int64], NDArray[np.int64]]
) -> tuple[Covariate, ...]:
    """Return the switchings of turning and of driving in each window.

    Args:
        rates: Rates of turning and of driving.
        trials: Number of rows of each trial.
        windows: First and last row (m,) of each window. A switching in the first row is before the window.
    """
    turn, travel = rates
    return (
        _switchings("turn_reversal_rad_s", turn.values, turn.floor, trials, windows),
        _switchings("travel_reversal_m_s", travel.values, travel.floor, trials, windows),
    )


def switchings(rate: Array, threshold: float) -> Array:
    """Return the rows (n,) in which a relay switches: 1 to the positive side, -1 to the negative one, 0 elsewhere.

    Args:
        rate: (n,), rate in each row of a trial.
        threshold: Rate that must be exceeded on either side.
    """
    switched = np.zeros(len(rate))
    beyond = np.flatnonzero(np.abs(rate) > threshold)
    sign = np.sign(rate[beyond])
    others = np.flatnonzero(sign[1:] != sign[:-1]) + 1
    switched[beyond[others]] = sign[others]
    return switched


def _switchings(
    name: str,
    rate: Array,
    floor: float,
    trials: Sequence[int],
    windows: tuple[NDArray[np.int64], NDArray[np.int64]],
) -> Covariate:
    """Return how often each relay switches to the positive side in a window, less how often to the negative one."""
    first, last = windows
    begins = np.cumsum([0, *trials[:-1]])
    rate = rate.copy()
    rate[begins] = 0.0
    thresholds = np.unique(np.maximum(np.quantile(np.abs(rate), LARGEST) * np.array(THRESHOLDS), floor))
    levels, highest = np.zeros((len(first), len(thresholds))), np.zeros(len(first))
    for k, threshold in enumerate(thresholds.tolist()):
        switched = np.concatenate([switchings(part, threshold) for part in np.split(rate, begins[1:])])
        total = np.cumsum(switched)
        levels[:, k] = total[last] - total[first]
        highest = np.where(levels[:, k] != 0.0, np.copysign(threshold, levels[:, k]), highest)
    return Covariate(name, highest, CovariateShape.EVENT, levels=levels)
