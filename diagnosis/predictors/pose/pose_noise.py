"""Noise of the logged poses, and of the wheels between them."""

from dataclasses import dataclass

import numpy as np

from diagnosis.measured.case_files.nominal import NominalDrive, NominalLog
from diagnosis.measured.measurement import Measurement
from diagnosis.measured.screening import noise_of

MIN_NOISE = 1e-6
"""Noise of a pose [m, rad] that is stated as exact: it is rounded all the same."""
UNSTATED_SLIP = 1e-3
"""Noise of the travelled distance [m / sqrt m] if it is not stated: a millimetre per metre."""


@dataclass(frozen=True)
class PoseNoise:
    """Noise of the logged poses and of the wheels."""

    xy_m: float
    theta_rad: float
    slip_m_per_sqrt_m: float

    @classmethod
    def from_measurement(cls, measurement: Measurement) -> "PoseNoise":
        """Return the noise that the case states, else that of the camera, estimated from its channels."""
        if isinstance(measurement.nominal, NominalDrive):
            noise = measurement.nominal.noise
            return cls(noise.pose_xy_m, noise.pose_theta_rad, noise.travel_m_per_sqrt_m)
        if isinstance(measurement.nominal, NominalLog):
            noise = measurement.nominal.noise
            return cls(max(noise.pose_xy_m, MIN_NOISE), max(noise.pose_theta_rad, MIN_NOISE), UNSTATED_SLIP)
        xy_m, theta_rad = (_camera_noise(measurement, name) for name in ("x_m", "theta_rad"))
        return cls(xy_m, theta_rad, UNSTATED_SLIP)


def _camera_noise(measurement: Measurement, name: str) -> float:
    noises = [noise_of(channel) for channel in measurement.across(name)]
    known = [noise.sd for noise in noises if noise is not None and noise.sd > 0.0]
    return float(np.median(known)) if known else 1e-3
