"""Resampling without bias, scattering that keeps mean and covariance, and the posterior of a linear case."""

import numpy as np
import pytest

from pipeline.baselines.particles import METHOD, SCATTER, resampled, scattered
from pipeline.baselines.robot_knowledge import Start


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


def test_scattering_keeps_mean_and_covariance():
    rng = np.random.Generator(np.random.PCG64(6))
    root = np.array([[0.3, 0.0, 0.0], [0.2, 0.05, 0.0], [-0.1, 0.0, 1.0]])
    count = 40_000
    particles = 5.0 + rng.normal(size=(count, 3)) @ root.T
    moved = scattered(particles, rng)
    sd = particles.std(axis=0)
    assert np.all(np.abs(moved.mean(axis=0) - particles.mean(axis=0)) < 4.0 * SCATTER * sd / np.sqrt(count))
    assert np.all(np.abs(np.cov(moved.T) - np.cov(particles.T)) < 0.02 * np.outer(sd, sd))
    assert np.abs(moved - particles).max() > 0.1


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
