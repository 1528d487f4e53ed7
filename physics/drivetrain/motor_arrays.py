"""The exact step of `physics.drivetrain.motor` for arrays of wheels, at constant stall torque and friction."""

from typing import NamedTuple

import numpy as np

from symolo.core.arrays import Array


class HeldDrive(NamedTuple):
    """Quantities that are constant over a step; all of one shape or broadcast to it.

    Thousands are made in each simulation, and a frozen dataclass takes twice as long.
    """

    torque_N_m: Array
    """Torque on a wheel at rest."""
    damping_N_m_s_rad: Array
    friction_N_m: Array
    inertia_kg_m2: Array

    def step(self, speed_rad_s: Array, duration_s: float | Array, covered: Array | None = None) -> tuple[Array, Array]:
        """Return speed [rad/s] after the step and turned angle [rad], through a stop and a start within it.

        Args:
            speed_rad_s: Speed before the step.
            duration_s: Duration of the step.
            covered: `covered_share` of the step, if it is known already.
        """
        time_constant = self.inertia_kg_m2 / self.damping_N_m_s_rad
        final = self._final(speed_rad_s)
        covered = covered_share(duration_s, time_constant) if covered is None else covered
        speed, angle = _relaxed(speed_rad_s, final, duration_s, time_constant, covered)
        if not _changes_direction(speed_rad_s, speed):
            return speed, angle
        return self._through_stops(speed_rad_s, final, duration_s, time_constant)

    def speed_after(self, speed_rad_s: Array, duration_s: float | Array, covered: Array) -> Array:
        """Return the speed of `step` alone."""
        final = self._final(speed_rad_s)
        speed = speed_rad_s + (final - speed_rad_s) * covered
        if not _changes_direction(speed_rad_s, speed):
            return speed
        return self._through_stops(speed_rad_s, final, duration_s, self.inertia_kg_m2 / self.damping_N_m_s_rad)[0]

    def _final(self, speed_rad_s: Array) -> Array:
        """Return the speed that a wheel would reach if its direction stayed."""
        torque, friction = self.torque_N_m, self.friction_N_m
        if np.count_nonzero(speed_rad_s) == speed_rad_s.size:
            return (torque - np.copysign(friction, speed_rad_s)) / self.damping_N_m_s_rad
        # At rest, friction holds against any torque up to its size.
        holding = np.copysign(np.minimum(np.abs(torque), friction), torque)
        resisting = np.where(speed_rad_s == 0.0, holding, np.copysign(friction, speed_rad_s))
        return (torque - resisting) / self.damping_N_m_s_rad

    def _through_stops(
        self, speed_rad_s: Array, final: Array, duration_s: float | Array, time_constant: Array
    ) -> tuple[Array, Array]:
        # First up to the stop of each wheel, if it comes, then from rest with the friction against the new motion.
        comes_to_rest = np.sign(final) * speed_rad_s < 0.0
        ratio = np.divide(speed_rad_s, final, out=np.zeros(final.shape), where=comes_to_rest)
        stops_after = np.where(comes_to_rest, time_constant * np.log1p(-ratio), np.inf)
        first_s = np.minimum(stops_after, duration_s)
        speed, angle = _relaxed(speed_rad_s, final, first_s, time_constant, covered_share(first_s, time_constant))
        stops = stops_after <= duration_s
        starts = stops & (np.abs(self.torque_N_m) > self.friction_N_m)
        final = (self.torque_N_m - np.copysign(self.friction_N_m, self.torque_N_m)) / self.damping_N_m_s_rad
        left_s = duration_s - first_s
        covered = covered_share(left_s, time_constant)
        started, further = _relaxed(np.zeros_like(speed), final, left_s, time_constant, covered)
        return np.where(starts, started, np.where(stops, 0.0, speed)), angle + np.where(starts, further, 0.0)


def covered_share(duration_s: float | Array, time_constant_s: Array) -> Array:
    """Return the share of the difference to its final speed that a wheel covers in a time."""
    return -np.expm1(-duration_s / time_constant_s)


def _changes_direction(before_rad_s: Array, after_rad_s: Array) -> bool:
    """Return whether a wheel would turn the other way, so that it stops within the step; usually none does."""
    return bool(np.count_nonzero(after_rad_s * before_rad_s < 0.0))


def _relaxed(
    start: Array, final: Array, duration_s: float | Array, time_constant_s: Array, covered: Array
) -> tuple[Array, Array]:
    change = final - start
    return start + change * covered, final * duration_s - change * time_constant_s * covered
