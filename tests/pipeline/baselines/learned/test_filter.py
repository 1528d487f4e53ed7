"""The filter with heat maps that are known: the posterior of a linear case, and a lap whose wheels are too small."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.baselines.learned.heat_map import PoseGrid, PoseLikelihood
from pipeline.baselines.learned.method import filtered
from pipeline.baselines.motion import SHARES_SD
from pipeline.baselines.robot_knowledge import RunImages, Start

PIXELS = np.zeros((12, 16, 3), np.uint8)


def even(grid, wrong):
    count = int(np.prod(grid.shape))
    return PoseLikelihood(grid, np.arange(count), np.full(count, 1.0 / count), wrong)


def bells(grid, poses, sd):
    """Heat maps (M, C) with a bell of these standard deviations (3,) around each pose."""
    middles = grid.middles(np.arange(int(np.prod(grid.shape))))
    away = middles - poses[:, None]
    away[..., 2] = np.angle(np.exp(1j * away[..., 2]))
    heat = np.exp(-0.5 * ((away / sd) ** 2).sum(axis=2))
    return heat / heat.sum(axis=1, keepdims=True)


def with_images(knowledge, rows):
    return replace(knowledge, images=RunImages(np.array(rows), lambda _: PIXELS))


def test_one_heat_map_moves_the_start_as_a_gaussian_measurement_does(before_a_wall):
    """A robot that stands: mean and variance are those of two Gaussians that are multiplied."""
    grid = PoseGrid(-0.6, -0.6, 0.02, 61, 61, 1)
    start_sd, read_sd = 0.1, 0.1
    start = Start(np.array([0.0, 0.0, 0.0]), np.array([start_sd, start_sd, 1e-6]))
    knowledge = with_images(before_a_wall(np.zeros((3, 2)), np.full(3, 0.5), start), [1])
    heat = bells(grid, np.array([[0.1, -0.1, 0.0]]), np.array([read_sd, read_sd, 1.0]))
    results = [
        filtered(knowledge, even(grid, 1e-6), heat, np.random.Generator(np.random.PCG64(seed))) for seed in range(4)
    ]
    pose = np.mean([result.pose[-1] for result in results], axis=0)
    variance = np.mean([result.covariance[-1].diagonal() for result in results], axis=0)
    gain = start_sd**2 / (start_sd**2 + read_sd**2)
    assert pose[:2] == pytest.approx([0.1 * gain, -0.1 * gain], abs=0.008)
    assert variance[:2] == pytest.approx([gain * read_sd**2] * 2, rel=0.15)


def test_heat_maps_correct_wheels_that_are_too_small(before_a_wall):
    """As the least squares fit of the wheel size to nine positions, beside what is known of wheels."""
    rows, step_m, smaller, read_sd, cell_m = 200, 0.012, 0.01, 0.03, 0.02
    start = Start(np.zeros(3), np.full(3, 1e-5))
    believed = np.full((rows, 2), step_m)
    believed[0] = 0.0
    believed_x_m = np.cumsum(believed[:, 0])
    at = np.arange(20, rows, 20)
    grid = PoseGrid(-0.2, -0.2, cell_m, 130, 21, 1)
    nothing = np.zeros(len(at))
    heat = bells(grid, np.column_stack(((1.0 - smaller) * believed_x_m[at], nothing, nothing)), np.full(3, read_sd))
    knowledge = with_images(before_a_wall(believed, np.full(rows, np.nan), start), at)
    seeds = [np.random.Generator(np.random.PCG64(seed)) for seed in range(3)]
    results = [filtered(knowledge, even(grid, 1e-3), heat, rng) for rng in seeds]
    shown = (believed_x_m[at] ** 2).sum() / (read_sd**2 + cell_m**2 / 6)  # linear interpolation widens a bell so much
    share = shown / (shown + 1.0 / SHARES_SD[0] ** 2)
    ends = [result.pose[-1, 0] for result in results]
    assert np.mean(ends) == pytest.approx(believed_x_m[-1] * (1.0 - share * smaller), abs=0.003)
    assert share * smaller * believed_x_m[-1] >= 0.009, "the heat maps matter"
    assert np.array_equal(results[0].rows, np.arange(rows))
