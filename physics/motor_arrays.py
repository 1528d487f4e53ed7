"""The exact step of `physics.motor` for arrays of wheels, for as long as torque at rest and friction are held."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class HeldDrive:
    """What is constant over a step; all of one shape or broadcast to it."""

    torque_N_m: Array
    """On a wheel at rest."""
    damping_N_m_s_rad: Array
    friction_N_m: Array
    inertia_kg_m2: Array

    def step(self, speed_rad_s: Array, duration_s: float | Array) -> tuple[Array, Array]:
        """Speed [rad/s] after the step and angle [rad] turned meanwhile, through a stop and a start within it."""
        torque, friction, damping = self.torque_N_m, self.friction_N_m, self.damping_N_m_s_rad
        time_constant = self.inertia_kg_m2 / damping
        standing = speed_rad_s == 0.0
        final = (torque - np.copysign(friction, np.where(standing, torque, speed_rad_s))) / damping
        final = np.where(standing & (np.abs(torque) <= friction), 0.0, final)
        speed, angle = _relaxed(speed_rad_s, final, duration_s, time_constant)
        if not (speed * speed_rad_s < 0.0).any():
            return speed, angle
        return self._through_stops(speed_rad_s, final, duration_s, time_constant)

    def _through_stops(
        self, speed_rad_s: Array, final: Array, duration_s: float | Array, time_constant: Array
    ) -> tuple[Array, Array]:
        comes_to_rest = final * speed_rad_s < 0.0
        ratio = np.divide(speed_rad_s, final, out=np.zeros(final.shape), where=comes_to_rest)
        stops_after = np.where(comes_to_rest, time_constant * np.log1p(-ratio), np.inf)
        first_s = np.minimum(stops_after, duration_s)
        speed, angle = _relaxed(speed_rad_s, final, first_s, time_constant)
        stops = stops_after <= duration_s
        starts = stops & (np.abs(self.torque_N_m) > self.friction_N_m)
        final = (self.torque_N_m - np.copysign(self.friction_N_m, self.torque_N_m)) / self.damping_N_m_s_rad
        started, further = _relaxed(np.zeros_like(speed), final, duration_s - first_s, time_constant)
        return np.where(starts, started, np.where(stops, 0.0, speed)), angle + np.where(starts, further, 0.0)


def _relaxed(start: Array, final: Array, duration_s: float | Array, time_constant_s: Array) -> tuple[Array, Array]:
    lost = -np.expm1(-duration_s / time_constant_s)
    return start + (final - start) * lost, final * duration_s + (start - final) * time_constant_s * lost
