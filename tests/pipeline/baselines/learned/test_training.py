"""Training with PyTorch: it learns twenty images by heart, gives the same model again, and locates from its file."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.baselines.learned.heat_map import PoseGrid
from pipeline.baselines.learned.readings import HEIGHT, WIDTH, NetworkReadings
from pipeline.baselines.learned.torch_side.training import Samples, train
from symolo.core.progress import LineReport

pytestmark = pytest.mark.learned

GRID = PoseGrid(-0.5, -0.5, 0.1, 12, 12, 12)


@pytest.fixture(scope="module")
def twenty():
    """Images with a bright square whose place shows the position, and ranges that show the heading."""
    rng = np.random.Generator(np.random.PCG64(11))
    pose = np.column_stack((rng.uniform(-0.4, 0.5, (20, 2)), rng.uniform(-3.0, 3.0, 20)))
    grey = np.full((20, HEIGHT, WIDTH), 0.4)
    for image, (x_m, y_m, _) in zip(grey, pose, strict=True):
        left, top = int(60 * (x_m + 0.4)), int(44 * (y_m + 0.4))
        image[top : top + 8, left : left + 8] = 0.9
    share = 0.5 + 0.4 * np.column_stack((np.sin(pose[:, 2]), np.cos(pose[:, 2]), np.zeros(20)))
    return Samples(NetworkReadings(grey, np.column_stack((np.ones((20, 3)), share))), pose)


def model_of(samples, inputs=("images", "ranges"), epochs=60):
    cells = GRID.cells_near(samples.pose)
    with LineReport().stage("train", epochs, "epochs") as stage:
        return train(samples, samples, inputs, GRID, cells, max_epochs=epochs, seed=5, stage=stage)


def test_it_learns_twenty_images_by_heart(twenty):
    assert model_of(twenty).median_m < 0.08, "a cell has a side of 0.1 m"


def test_images_alone_show_the_position_here_and_ranges_alone_do_not(twenty):
    assert model_of(twenty, ("images",)).median_m < 0.08
    without = replace(twenty, readings=NetworkReadings(twenty.readings.grey, np.zeros((20, 6))))
    assert model_of(without, ("ranges",), epochs=20).median_m > 0.2


def test_the_same_seed_gives_the_same_weights(twenty):
    one, two = model_of(twenty, epochs=4), model_of(twenty, epochs=4)
    assert all(np.array_equal(one.weights[name], two.weights[name]) for name in one.weights)


def test_from_a_release_to_a_model_to_a_table(symolo, dataset, tmp_path):
    for name in ("one", "two"):
        ended = symolo("train", dataset, "--out", tmp_path / f"{name}.npz", "--epochs", "2")
        assert ended.code == 0, ended.err
    assert (tmp_path / "one.npz").read_bytes() == (tmp_path / "two.npz").read_bytes()
    assert "set aside" in ended.out
    arguments = ["--methods", "odometry,learned", "--model", tmp_path / "one.npz", "--out", tmp_path / "out"]
    ended = symolo("baselines", dataset, *arguments)
    assert ended.code == 0, ended.err
    assert "| CW/test_1 | learned |" in ended.out
    assert "a trained network on images and ranges" in ended.out
    assert "warning: 2 of these 2 runs trained the model" in ended.err
    assert "2 of these 2 runs trained the model" in (tmp_path / "out/baselines.md").read_text()
