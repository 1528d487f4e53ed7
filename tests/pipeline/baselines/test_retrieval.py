"""Retrieval on painted images, of which it is known which places look alike."""

from dataclasses import replace

import numpy as np

from pipeline.baselines.base import TrainingRun
from pipeline.baselines.retrieval import METHOD
from pipeline.baselines.robot_knowledge import RunImages, Start

COUNT = 40
NO_RNG = np.random.Generator(np.random.PCG64(0))


def painted(positions, brightness, seed):
    """A tilted edge whose place and slope tell the position, under another light and with noise."""
    rng = np.random.Generator(np.random.PCG64(seed))
    row, column = np.mgrid[0:48, 0:64]
    images = []
    for position in positions:
        above = (row - 24 + (column - 32) * 0.5 * (position - 1.5)) > 10 * (position - 1.5)
        grey = brightness * np.where(above, 0.8, 0.4) + 0.005 * rng.standard_normal(row.shape)
        images.append(np.repeat(np.clip(255 * grey, 0, 255).astype(np.uint8)[..., None], 3, axis=2))
    return RunImages(np.arange(len(positions)), lambda index: images[index])


def training_run(seed, brightness, looks_like=lambda x: x):
    x = np.linspace(0.0, 3.0, COUNT) + 0.01 * seed
    return TrainingRun(painted(looks_like(x), brightness, seed), np.column_stack([x, 0.5 * x, 0.1 * x]))


def asked(before_a_wall, images):
    start = Start(np.zeros(3), np.ones(3))
    return replace(before_a_wall(np.zeros((COUNT, 2)), np.full(COUNT, np.nan), start), images=images)


def test_under_another_light_a_place_is_found_again(before_a_wall):
    training_runs = [training_run(1, 0.5), training_run(2, 0.9), training_run(3, 0.7)]
    test = training_run(4, 0.6)
    estimate = METHOD.estimate(asked(before_a_wall, test.images), training_runs, NO_RNG)
    off_m = np.abs(estimate.pose[:, 0] - test.pose[:, 0])
    assert np.median(off_m) < 0.08
    assert estimate.rows.tolist() == list(range(COUNT))


def test_where_two_places_look_alike_it_is_unsure(before_a_wall):
    """The second half of the way looks as the first does."""

    def folded(x):
        return x % 1.5

    twofold, clear = (
        [training_run(seed, 0.5 + 0.1 * seed, looks) for seed in (1, 2, 3)] for looks in (folded, lambda x: x)
    )
    sd = {}
    for name, training_runs, looks in (("twofold", twofold, folded), ("clear", clear, lambda x: x)):
        test = training_run(4, 0.6, looks)
        estimate = METHOD.estimate(asked(before_a_wall, test.images), training_runs, NO_RNG)
        sd[name] = np.sqrt(estimate.covariance[:, 0, 0])
    assert np.median(sd["twofold"]) > 0.5
    assert np.median(sd["twofold"]) > 2.0 * np.median(sd["clear"])


def test_from_one_image_it_learns_that_one_pose(before_a_wall):
    only = training_run(1, 0.5)
    one = TrainingRun(RunImages(np.arange(1), only.images.pixels), only.pose[:1])
    estimate = METHOD.estimate(asked(before_a_wall, training_run(2, 0.6).images), [one], NO_RNG)
    assert np.allclose(estimate.pose, only.pose[0], atol=1e-12)
    assert np.all(np.linalg.eigvalsh(estimate.covariance) > 0.0)
