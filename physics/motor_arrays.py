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

    def step(self, speed_rad_s: Array, duration_s: float) -> tuple[Array, Array]:
        """Speed [rad/s] after the step and angle [rad] turned meanwhile, through a stop and a start within it."""
        time_constant = self.inertia_kg_m2 / self.damping_N_m_s_rad
        moving = speed_rad_s != 0.0
        final = (self.torque_N_m - np.copysign(self.friction_N_m, speed_rad_s)) / self.damping_N_m_s_rad
        comes_to_rest = moving & (final * speed_rad_s < 0.0)
        if moving.all() and not comes_to_rest.any():
            return _relaxed(speed_rad_s, final, np.full_like(final, duration_s), time_constant)
        ratio = np.divide(speed_rad_s, final, out=np.zeros_like(speed_rad_s), where=comes_to_rest)
        stops_after = np.where(comes_to_rest, time_constant * np.log1p(-ratio), np.inf)
        first_s = np.where(moving, np.minimum(stops_after, duration_s), 0.0)
        speed, angle = _relaxed(speed_rad_s, final, first_s, time_constant)
        speed = np.where(stops_after <= duration_s, 0.0, speed)
        starts = (speed == 0.0) & (np.abs(self.torque_N_m) > self.friction_N_m)
        final = (self.torque_N_m - np.copysign(self.friction_N_m, self.torque_N_m)) / self.damping_N_m_s_rad
        started, further = _relaxed(np.zeros_like(speed), final, duration_s - first_s, time_constant)
        return np.where(starts, started, speed), angle + np.where(starts, further, 0.0)


def _relaxed(start: Array, final: Array, duration_s: Array, time_constant_s: Array) -> tuple[Array, Array]:
    lost = -np.expm1(-duration_s / time_constant_s)
    return start + (final - start) * lost, final * duration_s + (start - final) * time_constant_s * lost
