"""The gyroscope of a robot: its turns from row to row, and the sizes of its errors as its data sheet states them."""

from dataclasses import dataclass

import numpy as np

from sensors.inertial.imu import Imu, ImuSettings
from sensors.inertial.inertial_errors import FLICKER, ErrorSizes
from symolo.core.arrays import Array

FLOOR_S = 100.0
"""Time [s] after which a random walk has the Allan deviation of the bias instability, for which it stands here."""


@dataclass(frozen=True)
class ImuLog:
    """Readings of an IMU about the vertical axis of the robot."""

    t_s: Array
    """(M,), times of the samples [s]."""
    yaw_rate_rad_s: Array
    """(M,), angular rate about z of R, the mean since the sample before."""
    over_K: Array
    """(M,), temperature above that of the calibration."""
    errors: ErrorSizes
    """Sizes of the errors in the description of the robot; the errors themselves are not known."""
    step_rad_s: float
    """Difference between two neighbouring readings, to which they are rounded."""

    @classmethod
    def from_table(cls, settings: ImuSettings, table: Array) -> "ImuLog":
        """Return the log in the table of an IMU, (M, columns) with the time [ms] first."""
        names = ["t", *(column.name for column in Imu.columns)]
        rates = table[:, names.index("gyro_x") :][:, :3]
        over_K = table[:, names.index("temperature")] - settings.calibrated_at_C
        errors = settings.gyroscope.sizes()
        step_rad_s = 2.0 * errors.range / 2**settings.bits
        return cls(table[:, 0] / 1000, rates @ settings.X_RS()[2, :3], over_K, errors, step_rad_s)

    @property
    def noise_rad2_s(self) -> float:
        """Growth of the variance of the sum of all turns per second: white noise, and rounding of each sample."""
        period_s = float(np.median(np.diff(self.t_s))) if len(self.t_s) > 1 else 0.0
        return self.errors.noise_density**2 + period_s * self.step_rad_s**2 / 12.0

    @property
    def walk_rad2_s3(self) -> float:
        """Growth of the variance of the bias per second: its random walk, and one for the bias instability."""
        return self.errors.random_walk**2 + 3.0 * FLICKER * self.errors.bias_instability**2 / FLOOR_S

    def between(self, t_s: Array) -> tuple[Array, Array]:
        """Return the turns [rad] and the integrals of the temperature [K s] since the time before, (N,) each."""
        period_s = np.diff(self.t_s, prepend=self.t_s[0])
        turned, warmed = np.cumsum(self.yaw_rate_rad_s * period_s), np.cumsum(self.over_K * period_s)
        at = [np.interp(t_s, self.t_s, total) for total in (turned, warmed)]
        turns, warmth = (np.diff(values, prepend=values[0]) for values in at)
        return turns, warmth
