"""Resampling without bias that keeps mean and covariance, and the posteriors of linear cases."""

import numpy as np
import pytest

from pipeline.baselines.ekf import updated
from pipeline.baselines.motion import WheelMotion, initial_state
from pipeline.baselines.particles import METHOD, ParticleCloud, bandwidth, regularised, resampled, with_moments
from pipeline.baselines.robot_knowledge import Start
from symolo.dataset.tables.rows import wrapped


def test_each_particle_goes_on_as_often_as_its_weight_says_in_the_mean():
    weight = np.random.Generator(np.random.PCG64(4)).dirichlet(np.ones(7))
    offsets = (np.arange(2000) + 0.5) / 2000
    counts = [np.bincount(resampled(weight, offset), minlength=7) for offset in offsets]
    assert np.mean(counts, axis=0) == pytest.approx(7 * weight, abs=0.005)


def test_no_particle_goes_on_more_than_one_time_off_its_weight():
    """What low variance sampling is for."""
    weight = np.random.Generator(np.random.PCG64(5)).dirichlet(np.ones(50))
    counts = np.bincount(resampled(weight, 0.37), minlength=50)
    assert np.abs(counts - 50 * weight).max() < 1.0


def test_the_bandwidth_is_that_of_silverman():
    """His formula is 1.06 N^(-1/5) in one dimension and N^(-1/6) in two."""
    assert bandwidth(300, 1) == pytest.approx(1.06 * 300 ** (-1 / 5), rel=0.002)
    assert bandwidth(300, 2) == pytest.approx(300 ** (-1 / 6))


def test_particles_get_the_moments_that_are_asked_for():
    rng = np.random.Generator(np.random.PCG64(6))
    root = np.array([[0.3, 0.2, -0.1], [0.0, 0.05, 0.0], [0.0, 0.0, 1.0]])
    particles = with_moments(rng.standard_normal((20, 3)), np.array([5.0, 0.0, -2.0]), root)
    assert particles.mean(axis=0) == pytest.approx([5.0, 0.0, -2.0])
    assert np.cov(particles.T, ddof=0) == pytest.approx(root.T @ root)


def test_resampling_keeps_mean_and_covariance_exactly():
    rng = np.random.Generator(np.random.PCG64(6))
    root = np.array([[0.3, 0.0, 0.0], [0.2, 0.05, 0.0], [-0.1, 0.0, 1.0]])
    particles = 5.0 + rng.normal(size=(300, 3)) @ root.T
    weight = rng.dirichlet(np.ones(300))
    after = regularised(particles, weight, rng)
    assert after.mean(axis=0) == pytest.approx(weight @ particles)
    assert np.cov(after.T, ddof=0) == pytest.approx(np.cov(particles.T, ddof=0, aweights=weight))
    assert len(np.unique(after, axis=0)) == 300


def test_resampling_keeps_two_separate_groups_apart():
    """A Gaussian with their mean and variance has 16 % of its mass between them, within 0.2."""
    rng = np.random.Generator(np.random.PCG64(8))
    particles = np.where(np.arange(300) < 150, -1.0, 1.0)[:, None] + 0.01 * rng.standard_normal((300, 1))
    after = regularised(particles, np.full(300, 1 / 300), rng)
    assert np.mean(np.abs(after) < 0.2) < 0.05


@pytest.mark.parametrize("heavy", [1, 3])
def test_particles_that_share_one_place_or_plane_stay_there(heavy):
    rng = np.random.Generator(np.random.PCG64(9))
    particles = rng.standard_normal((50, 6))
    weight = np.where(np.arange(50) < heavy, 1.0 / heavy, 0.0)
    after = regularised(particles, weight, rng)
    assert after.mean(axis=0) == pytest.approx(weight @ particles)
    assert np.cov(after.T, ddof=0) == pytest.approx(np.cov(particles.T, ddof=0, aweights=weight), abs=1e-12)


def test_headings_a_turn_apart_stay_one_heading_in_resampling(before_a_wall):
    """All particles look back, by half a turn to the left or to the right, so their mean is no half turn less."""
    start = Start(np.zeros(3), np.array([0.1, 0.1, np.radians(90.0)]))
    rng = np.random.Generator(np.random.PCG64(11))
    cloud = ParticleCloud(before_a_wall(np.zeros((1, 2)), np.full(1, np.nan), start), rng)
    cloud.particles[:, 2] = np.where(np.arange(300) % 2, np.pi, -np.pi) + 0.05 * rng.standard_normal(300)
    cloud.weigh(np.where(np.arange(300) < 150, 0.0, -9.0), 1.0)
    assert np.ptp(cloud.log_weight) == 0.0
    assert np.std(wrapped(cloud.particles[:, 2] - np.pi)) == pytest.approx(0.05, rel=0.2)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_robot_with_unusual_wheels_has_the_posterior_of_a_kalman_filter(before_a_wall, seed):
    """Readings of the place are linear and Gaussian; the wheels are 2.5, 2 and 1.5 standard deviations off."""
    rng = np.random.Generator(np.random.PCG64(seed))
    start = Start(np.zeros(3), np.array([0.001, 0.001, np.radians(0.1)]))
    knowledge = before_a_wall(np.zeros((1, 2)), np.full(1, np.nan), start)
    motion = WheelMotion.from_knowledge(knowledge)
    cloud = ParticleCloud(knowledge, np.random.Generator(np.random.PCG64(seed + 10)))
    state, covariance = initial_state(start)
    true = state + np.sqrt(covariance.diagonal()) * np.concatenate([rng.standard_normal(3), [-2.5, -2.0, 1.5]])
    squares, spreads = [], []
    for row in range(600):
        turn = 0.025 if row // 60 % 2 else 0.0
        rolled_m = 0.008 + 0.5 * motion.odometry.track_m * np.array([turn, -turn])
        true = motion.moved(true, rolled_m + motion.slip_sd_m(rolled_m) * rng.standard_normal(2))
        by_state, by_rolled = motion.jacobians(state, rolled_m)
        noise = (by_rolled * motion.slip_sd_m(rolled_m) ** 2) @ by_rolled.T
        state, covariance = motion.moved(state, rolled_m), by_state @ covariance @ by_state.T + noise
        cloud.predict(rolled_m)
        for axis, sd_m in enumerate([0.025, 0.025]):
            reading_m = true[axis] + sd_m * rng.standard_normal()
            state, covariance = updated(state, covariance, np.eye(6)[axis], reading_m - state[axis], sd_m**2)
            cloud.weigh(-0.5 * ((reading_m - cloud.particles[:, axis]) / sd_m) ** 2, 1.0)
        mean, spread = cloud.estimate()
        off = mean - state[:3]
        off[2] = wrapped(off[2])
        squares.append(off @ np.linalg.solve(covariance[:3, :3], off) / 3.0)
        spreads.append(np.linalg.det(spread) / np.linalg.det(covariance[:3, :3]))
    assert np.mean(squares) < 0.2
    assert 0.9 < np.median(spreads) ** (1 / 6) < 1.1


def test_a_wall_ahead_shows_its_distance_and_no_more(before_a_wall):
    rows = 40
    true_x_m = 0.28
    start = Start(np.array([0.26, 0.0, 0.0]), np.array([0.02, 0.02, 0.01]))
    given = before_a_wall(np.zeros((rows, 2)), np.full(rows, 0.415 - true_x_m), start)
    estimate = METHOD.estimate(given, (), np.random.Generator(np.random.PCG64(7)))
    sd = np.sqrt(estimate.covariance[-1].diagonal())
    assert estimate.pose[-1, 0] == pytest.approx(true_x_m, abs=3.0 * sd[0])
    assert sd[0] < 0.006
    assert sd[1] == pytest.approx(0.02, rel=0.25)
