"""Labels, interpolation and Bayes' rule on grids of few cells."""

import numpy as np
import pytest

from pipeline.baselines.learned.heat_map import MIN_PRIOR_SHARE, SOFT_CELLS, PoseGrid, PoseLikelihood


def test_a_label_is_a_bell_over_the_cells(grid):
    """Of a pose in the middle of a cell, the neighbour along any axis has exp(-1 / (2 sd^2)) of its share."""
    cells = np.arange(int(np.prod(grid.shape)))
    (label,) = grid.labels(np.array([[0.0, 0.0, 0.0]]), cells)
    of = label.reshape(grid.shape)
    assert label.sum() == pytest.approx(1.0)
    assert np.unravel_index(label.argmax(), grid.shape) == (5, 3, 0)
    neighbour = np.exp(-0.5 / SOFT_CELLS**2)
    assert [of[4, 3, 0], of[5, 4, 0], of[5, 3, 1], of[5, 3, 7]] == pytest.approx([neighbour * of[5, 3, 0]] * 4)
    assert of[4, 4, 1] == pytest.approx(neighbour**3 * of[5, 3, 0])


def test_the_heading_goes_on_after_a_full_turn(grid):
    cells = np.arange(int(np.prod(grid.shape)))
    poses = np.array([[0.1, 0.1, np.pi - 0.01], [0.1, 0.1, -np.pi - 0.01]])
    first, second = grid.labels(poses, cells)
    assert first == pytest.approx(second)


def test_the_middle_of_a_cell_is_its_pose(grid):
    cells = np.array([0, 8, 56 + 3])
    step = np.radians(45)
    assert grid.middles(cells) == pytest.approx(
        np.array([[-0.5, -0.3, 0.0], [-0.5, -0.2, 0.0], [-0.4, -0.3, 3 * step]])
    )
    assert grid.place(grid.middles(cells))[:, :2] == pytest.approx(np.array([[0, 0], [0, 1], [1, 0]]))


def test_a_grid_contains_its_poses_and_the_cells_near_them():
    poses = np.array([[0.23, -1.1, 0.4], [1.9, 0.35, -3.1]])
    grid = PoseGrid.around(poses, 0.05, 24)
    cells = grid.cells_near(poses)
    place = grid.place(poses)[:, :2]
    assert np.all(place >= 1.0)
    assert np.all(place <= np.array(grid.shape[:2]) - 2.0)
    assert np.all(np.diff(cells) > 0)
    away = np.abs(grid.middles(cells)[:, None, :2] - poses[:, :2]).max(axis=2).min(axis=1)
    assert away.max() <= 0.075 + 1e-9, "no cell is further than a cell and a half from a training pose"
    assert 2 <= len(cells) <= 2 * 27


@pytest.mark.parametrize("wrong", [0.02, 0.3])
def test_at_the_middle_of_a_cell_the_ratio_is_that_of_bayes(even, wrong):
    likelihood = even(wrong)
    count = len(likelihood.cells)
    heat = np.full(count, 0.5 / (count - 1))
    heat[100] = 0.5
    pose = likelihood.grid.middles(np.array([100, 300]))
    expected = [wrong + (1 - wrong) * 0.5 * count, wrong + (1 - wrong) * 0.5 * count / (count - 1)]
    assert np.exp(likelihood.log_ratio(heat, pose)) == pytest.approx(expected)


def test_between_two_cells_the_ratio_is_linear(even):
    likelihood = even(0.1)
    heat = np.zeros(len(likelihood.cells))
    heat[100] = 1.0
    here, there = likelihood.grid.middles(np.array([100, 108]))
    assert np.allclose(there - here, [0.0, 0.1, 0.0])
    shares = np.array([0.0, 0.25, 0.5, 1.0])
    ratio = np.exp(likelihood.log_ratio(heat, here + shares[:, None] * (there - here)))
    assert ratio == pytest.approx(ratio[0] + shares * (ratio[-1] - ratio[0]))
    assert ratio[-1] == pytest.approx(0.1)


def test_a_heat_map_that_repeats_the_training_poses_shows_nothing(grid):
    """A place where the training robots often were is not more likely for this."""
    prior = np.random.Generator(np.random.PCG64(2)).dirichlet(np.ones(50))
    likelihood = PoseLikelihood(grid, np.arange(50), prior, 0.05)
    heat = (1 - MIN_PRIOR_SHARE) * prior + MIN_PRIOR_SHARE / 50
    assert likelihood.log_ratio(heat, grid.middles(np.arange(50))) == pytest.approx(np.zeros(50))


def test_where_the_training_robots_never_were_a_heat_map_shows_nothing(grid):
    likelihood = PoseLikelihood(grid, np.array([5]), np.array([1.0]), 0.05)
    outside = np.array([[0.4, 0.2, 1.0], [7.0, -9.0, 0.0]])
    assert likelihood.log_ratio(np.array([1.0]), outside) == pytest.approx([0.0, 0.0])
