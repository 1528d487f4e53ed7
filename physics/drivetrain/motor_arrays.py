"""The exact step of `physics.drivetrain.motor` for arrays of wheels, while torque at rest and friction are held."""

from dataclasses import dataclass

import numpy as np

from symolo.core.arrays import Array


@dataclass(frozen=True)
class HeldDrive:
    """What is constant over a step; all of one shape or broadcast to it."""

    torque_N_m: Array
    """On a wheel at rest."""
    damping_N_m_s_rad: Array
    friction_N_m: Array
    inertia_kg_m2: Array

    def step(self, speed_rad_s: Array, duration_s: float | Array, behind: Array | None = None) -> tuple[Array, Array]:
        """Speed [rad/s] after the step and angle [rad] turned meanwhile, through a stop and a start within it.

        Args:
            speed_rad_s: Before it.
            duration_s: Of the step.
            behind: `share_behind` of the step, where it is known already.
        """
        torque, friction, damping = self.torque_N_m, self.friction_N_m, self.damping_N_m_s_rad
        time_constant = self.inertia_kg_m2 / damping
        standing = speed_rad_s == 0.0
        final = (torque - np.copysign(friction, np.where(standing, torque, speed_rad_s))) / damping
        final = np.where(standing & (np.abs(torque) <= friction), 0.0, final)
        behind = share_behind(duration_s, time_constant) if behind is None else behind
        speed, angle = _relaxed(speed_rad_s, final, duration_s, time_constant, behind)
        if not np.count_nonzero(np.sign(speed) * speed_rad_s < 0.0):
            return speed, angle
        return self._through_stops(speed_rad_s, final, duration_s, time_constant)

    def _through_stops(
        self, speed_rad_s: Array, final: Array, duration_s: float | Array, time_constant: Array
    ) -> tuple[Array, Array]:
        comes_to_rest = np.sign(final) * speed_rad_s < 0.0
        ratio = np.divide(speed_rad_s, final, out=np.zeros(final.shape), where=comes_to_rest)
        stops_after = np.where(comes_to_rest, time_constant * np.log1p(-ratio), np.inf)
        first_s = np.minimum(stops_after, duration_s)
        speed, angle = _relaxed(speed_rad_s, final, first_s, time_constant, share_behind(first_s, time_constant))
        stops = stops_after <= duration_s
        starts = stops & (np.abs(self.torque_N_m) > self.friction_N_m)
        final = (self.torque_N_m - np.copysign(self.friction_N_m, self.torque_N_m)) / self.damping_N_m_s_rad
        left_s = duration_s - first_s
        behind = share_behind(left_s, time_constant)
        started, further = _relaxed(np.zeros_like(speed), final, left_s, time_constant, behind)
        return np.where(starts, started, np.where(stops, 0.0, speed)), angle + np.where(starts, further, 0.0)


def share_behind(duration_s: float | Array, time_constant_s: Array) -> Array:
    """Share of the way to its final speed that a wheel has gone after a while."""
    return -np.expm1(-duration_s / time_constant_s)


def _relaxed(
    start: Array, final: Array, duration_s: float | Array, time_constant_s: Array, behind: Array
) -> tuple[Array, Array]:
    way = final - start
    return start + way * behind, final * duration_s - way * time_constant_s * behind
