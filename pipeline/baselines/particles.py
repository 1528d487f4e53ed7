"""Particle filter: odometry, weighted by ToF and line readings (Thrun, Burgard and Fox, Probabilistic Robotics, 2005,
sections 4.3, 6.3 and 8.3).

A particle is a pose and, as in the EKF, the parameters of the wheels. These are constant: motion does not spread them,
so what resampling loses of their spread is lost for the rest of the run. Resampling therefore draws from a smooth
density, whose kernel is as wide as so few particles need (the regularised particle filter of Musso, Oudjane and Le
Gland, "Improving regularised particle filters", 2001), and keeps the weighted mean and covariance exactly.

An error in one reading is in the next one too, so all readings of a second count as one (Probabilistic Robotics,
section 6.3.4): the logarithm of each likelihood is multiplied by the share of the second between two readings. The
offset of a sensor, and its turn in the mount, are errors of this kind; in the EKF they are states.
"""

from collections.abc import Sequence

import numpy as np
from scipy.special import logsumexp

from pipeline.baselines.base import Method, TrainingRun
from pipeline.baselines.line_model import LineModel
from pipeline.baselines.motion import WheelMotion, initial_state, rolled_distances_m
from pipeline.baselines.range_model import OFFSET_SD_M, RangeModel, lasting_sd_m, white_sd_m
from pipeline.baselines.robot_knowledge import RobotKnowledge
from symolo.core.arrays import Array
from symolo.dataset.tables.rows import Ints, wrapped
from symolo.evaluation.estimate import Estimate

PARTICLES = 300
RAYS = 6
AS_ONE_S = 1.0
"""Time [s] within which all readings count as one."""
ENOUGH = 0.8
"""Share of the particles that the effective sample size must not fall below. Early resampling makes its steps small."""
SEEN, SHORT, MISSED = 0.8, 0.15, 0.05
"""Shares of the readings where the map has a target: of the target, of an object before it, and without target."""
STRAY = 0.2
"""Share of readings with a target where the map has none."""
MIN_SD = np.array([1e-4, 1e-4, 1e-4])
"""Smallest standard deviation of the estimate, x [m], y [m], yaw [rad], even if all particles are at one place."""


def resampled(weight: Array, offset: float) -> Ints:
    """Return the particles that survive: each on average N times its weight (N,) (low variance sampling).

    Args:
        weight: Weights of the particles, (N,), with sum 1.
        offset: Offset of the comb, from 0 to 1.
    """
    comb = (np.arange(len(weight)) + offset) / len(weight)
    return np.minimum(np.searchsorted(np.cumsum(weight), comb, side="right"), len(weight) - 1)


def bandwidth(count: int, dimensions: int) -> float:
    """Return the standard deviation of a Gaussian kernel as a share of the spread of the particles.

    It is the best one for a normal density (Silverman, Density Estimation for Statistics and Data Analysis, 1986,
    section 4.3.2).
    """
    return float((4.0 / ((dimensions + 2.0) * count)) ** (1.0 / (dimensions + 4.0)))


def with_moments(particles: Array, mean: Array, root: Array) -> Array:
    """Return the particles (N, D) moved and stretched a little, so that their mean is `mean` (D,) and their covariance
    is root.T @ root, with a root (D, D) as `_root` returns it.

    Random draws have these moments only on average (second-order accuracy: Acevedo, de Wiljes and Reich, "Second-order
    accurate ensemble transform particle filters", SIAM Journal on Scientific Computing 39 (2017) A1834-A1850).
    """
    from_mean = particles - particles.mean(axis=0)
    stretch = np.linalg.lstsq(_root(from_mean / np.sqrt(len(particles))), root, rcond=None)[0]
    return mean + from_mean @ stretch


def regularised(particles: Array, weight: Array, rng: np.random.Generator) -> Array:
    """Return particles (N, D) of equal weight for particles of weights (N,): resampled and scattered.

    Mean and covariance stay exactly as they were. The particles move towards the mean by as much as the scattering
    spreads them (Liu and West, "Combined parameter and state estimation in simulation-based filtering", 2001).
    """
    mean = weight @ particles
    from_mean = particles - mean
    root = _root(np.sqrt(weight)[:, None] * from_mean)
    share = bandwidth(*particles.shape)
    noise = rng.standard_normal(particles.shape) @ root
    scattered = np.sqrt(1.0 - share**2) * from_mean[resampled(weight, rng.random())] + share * noise
    return with_moments(scattered, mean, root)


def _root(factor: Array) -> Array:
    """Return the upper triangle R (D, D) with a diagonal that is not negative and R.T @ R = factor.T @ factor."""
    _, root = np.linalg.qr(factor)
    sign: Array = np.copysign(1.0, np.diag(root))
    return sign[:, None] * root


class ParticleCloud:
    """Particles that follow the wheels, and are weighted by whatever a method reads."""

    def __init__(self, knowledge: RobotKnowledge, rng: np.random.Generator, count: int = PARTICLES) -> None:
        self._rng, self._count = rng, count
        self._motion = WheelMotion.from_knowledge(knowledge)
        state, covariance = initial_state(knowledge.start)
        drawn = rng.standard_normal((count, len(state)))
        self.particles = with_moments(drawn, state, np.linalg.cholesky(covariance).T)
        self.log_weight = np.full(count, -np.log(count))

    def predict(self, rolled_m: Array) -> None:
        """Move the particles by the distances (2,) that the wheels have rolled."""
        noise = self._motion.slip_sd_m(rolled_m) * self._rng.standard_normal((self._count, 2))
        self.particles = self._motion.moved(self.particles, rolled_m + noise)

    def weigh(self, log_likelihood: Array, since_s: float) -> None:
        """Weigh the particles by a reading, and resample them where few have most of the weight.

        Args:
            log_likelihood: Logarithm of the likelihood of the reading by each particle, (P,).
            since_s: Time [s] since the reading before.
        """
        self.log_weight += log_likelihood * min(since_s / AS_ONE_S, 1.0)
        self.log_weight -= logsumexp(self.log_weight)
        weight = np.exp(self.log_weight)
        if 1.0 / np.sum(weight**2) < ENOUGH * self._count:
            # Headings that are whole turns apart are equal, but not for mean and covariance.
            yaw = self.particles[:, 2]
            yaw -= 2.0 * np.pi * np.rint((yaw - yaw[np.argmax(weight)]) / (2.0 * np.pi))
            self.particles = regularised(self.particles, weight, self._rng)
            self.log_weight = np.full(self._count, -np.log(self._count))

    def estimate(self) -> tuple[Array, Array]:
        """Return mean pose (3,) and covariance (3, 3)."""
        weight = np.exp(self.log_weight - logsumexp(self.log_weight))
        x, y, yaw = self.particles[:, :3].T
        heading = float(np.arctan2(weight @ np.sin(yaw), weight @ np.cos(yaw)))
        mean = np.array([weight @ x, weight @ y, heading])
        from_mean = self.particles[:, :3] - mean
        from_mean[:, 2] = wrapped(from_mean[:, 2])
        return mean, (weight * from_mean.T) @ from_mean + np.diag(MIN_SD**2)


class _ParticleFilter(ParticleCloud):
    """Particles that are weighted by ranges and line readings."""

    def __init__(self, knowledge: RobotKnowledge, rng: np.random.Generator) -> None:
        super().__init__(knowledge, rng)
        self._ranges = RangeModel(knowledge, RAYS)
        self._line = LineModel(knowledge)
        self._longest_m = knowledge.drawing.longest_range_m

    def step(self, rolled_m: Array, duration_s: float, ranges_m: Array, fresh: np.ndarray, on_line: np.ndarray) -> None:
        """Follow the wheels for one row, and weigh the particles by its readings."""
        before = self.particles
        self.predict(rolled_m)
        log = self._line.log_likelihood(self.particles[:, :3], on_line)
        if fresh.any():
            earlier = self._ranges.age_s / duration_s if duration_s > 0.0 else 0.0
            seen_from = (self.particles - earlier * (self.particles - before))[:, :3]
            log += (self._range_log_likelihood(ranges_m, seen_from) * fresh).sum(axis=1)
        self.weigh(log, duration_s)

    def _range_log_likelihood(self, ranges_m: Array, seen_from: Array) -> Array:
        """Return the logarithm (P, 3) of the likelihood of the readings (3,) [m] from poses (P, 3)."""
        mean = np.exp(self.log_weight) @ seen_from
        expected_m, turn_m = self._ranges.expected_and_turn_error(seen_from, mean)
        target = ~np.isnan(expected_m)
        filled = np.where(target, expected_m, self._longest_m)
        sd_m = np.sqrt(white_sd_m(filled) ** 2 + lasting_sd_m(filled) ** 2 + OFFSET_SD_M**2 + turn_m**2)
        read = ~np.isnan(ranges_m)
        reading = np.where(read, ranges_m, 0.0)
        bell = np.exp(-0.5 * ((reading - filled) / sd_m) ** 2) / (np.sqrt(2.0 * np.pi) * sd_m)
        stray = 1.0 / self._longest_m
        of_target = np.where(read, SEEN * bell + SHORT * stray, MISSED)
        of_none = np.where(read, STRAY * stray, 1.0 - STRAY)
        return np.log(np.where(target, of_target, of_none))


def _estimate(knowledge: RobotKnowledge, _training_runs: Sequence[TrainingRun], rng: np.random.Generator) -> Estimate:
    particles = _ParticleFilter(knowledge, rng)
    estimates = []
    durations_s = np.diff(knowledge.t_s, prepend=0.0)
    readings = knowledge.ranges_m, knowledge.fresh, knowledge.on_line
    rows = zip(rolled_distances_m(knowledge), durations_s, *readings, strict=True)
    for rolled_m, duration_s, *row_readings in rows:
        particles.step(rolled_m, duration_s, *row_readings)
        estimates.append(particles.estimate())
    poses, covariances = zip(*estimates, strict=True)
    return Estimate(np.arange(len(knowledge)), np.array(poses), np.array(covariances))


METHOD = Method("particles", "particle filter", "odometry; particles weighted by ToF and line readings", _estimate)
