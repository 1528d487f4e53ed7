"""Smoothed poses: they follow a parabola exactly, and their noise does not depend on the delay."""

import numpy as np
import pytest

from diagnosis.inference.evidence.noise_level import lasting
from diagnosis.predictors.pose.delayed_pose import earlier
from diagnosis.predictors.pose.smoothed_pose import NOISE_SHARE, smoothed_earlier
from diagnosis.predictors.ranges.base import SHARED

ROW_S, ROWS = 0.05, 40
TIMES = ROW_S * np.arange(ROWS)


def parabola(t_s):
    return np.stack([0.1 + 0.2 * t_s, 0.3 * t_s - 0.4 * t_s**2, 2.0 + 5.0 * t_s**2], axis=-1)


@pytest.mark.parametrize("delay_s", [0.0, 0.011, 0.025, 0.12, -0.04])
def test_a_parabola_is_followed_at_every_delay(delay_s):
    path = smoothed_earlier(parabola(TIMES), TIMES, [ROWS], delay_s)
    # Outside the log, its first or last time is taken.
    wanted_s = np.clip(TIMES - delay_s, TIMES[0], TIMES[-1])
    np.testing.assert_allclose(path, parabola(wanted_s), atol=1e-9)


def test_the_noise_is_nearly_the_same_at_every_delay_and_less_than_that_of_a_row():
    """The pose depends linearly on the logged ones, so that its variance is the sum of the squares of their shares.

    A parabola through 7 rows with equal weights has 1/3 of the variance of a row in the middle (Savitzky and Golay,
    Anal. Chem. 36 (1964) 1627-1639: 7/21); less weight for the outer ones makes it more. Interpolation has 1 to 1/2.
    """
    shares = np.stack([np.eye(ROWS)] * 3, axis=-1)
    middle = ROWS // 2

    def variance(move, delay_s):
        return sum(move(shares[k], TIMES, [ROWS], delay_s)[middle, 0] ** 2 for k in range(ROWS))

    variances = [variance(smoothed_earlier, delay_s) for delay_s in np.linspace(0.0, ROW_S, 11)]
    assert min(variances) > 1.0 / 3.0
    assert max(variances) < 1.1 * min(variances) < 0.5
    assert np.sqrt(np.mean(variances)) == pytest.approx(NOISE_SHARE, abs=0.02)
    assert variance(earlier, 0.0) == 1.0
    assert variance(earlier, 0.5 * ROW_S) == pytest.approx(0.5)


def test_smoothed_poses_of_successive_rows_last_as_long_as_the_estimate_of_their_correlation_may_say():
    """The shares of a smoothed pose add up to 1, so that a mean over many rows has the noise that it had before."""
    rows = 4000
    noise = np.random.default_rng(1).standard_normal((rows, 1))
    smoothed = smoothed_earlier(noise, ROW_S * np.arange(rows), [rows], 0.0)[:, 0]
    assert lasting(smoothed / smoothed.std(), np.zeros(rows, dtype=int)) == pytest.approx(SHARED, abs=0.06)


def test_trials_do_not_see_each_other_and_a_short_one_is_interpolated():
    poses = np.concatenate([parabola(TIMES), 7.0 + parabola(TIMES), parabola(TIMES[:3])])
    times, trials = np.concatenate([TIMES, TIMES, TIMES[:3]]), [ROWS, ROWS, 3]
    path = smoothed_earlier(poses, times, trials, 0.02)
    alone = [smoothed_earlier(parabola(TIMES), TIMES, [ROWS], 0.02)] * 2
    np.testing.assert_allclose(path[: 2 * ROWS], np.concatenate([alone[0], 7.0 + alone[1]]), atol=1e-9)
    np.testing.assert_allclose(path[2 * ROWS :], earlier(parabola(TIMES[:3]), TIMES[:3], [3], 0.02))


@pytest.mark.parametrize("delay_s", [0.0, 0.03, 0.05, 0.1, 0.13, 0.15, 0.4])
@pytest.mark.parametrize("lost", [1, 2, 3, 4, 5, 6, 9])
def test_beside_a_gap_a_straight_line_is_followed_and_no_pose_is_noisier_than_a_row(lost, delay_s):
    times = np.delete(TIMES, np.arange(17, 17 + lost))
    wanted_s = np.clip(times - delay_s, times[0], times[-1])
    line = np.stack([times, 0.5 - 2.0 * times, 3.0 * times], axis=-1)
    path = smoothed_earlier(line, times, [len(times)], delay_s)
    np.testing.assert_allclose(path, np.stack([wanted_s, 0.5 - 2.0 * wanted_s, 3.0 * wanted_s], axis=-1), atol=1e-9)
    # Row k alone is 1 m in x in the k-th log: the x of all logs are the shares of the rows in each smoothed pose.
    shares = np.stack(
        [smoothed_earlier(np.outer(e, [1, 0, 0]), times, [len(times)], delay_s) for e in np.eye(len(times))]
    )
    assert (shares[..., 0] ** 2).sum(axis=0).max() <= 1.0 + 1e-12


@pytest.mark.parametrize("share", [1e-13, 1e-14, 4e-15, 1e-15])
def test_rows_at_the_very_edge_of_the_reach_determine_no_parabola(share):
    """Half-way between rows 19 and 20, rows 16 and 23 are within the reach by rounding alone. Beside them only rows 21
    and 22 are trusted, and two rows determine no parabola, so that the pose is interpolated.
    """
    steps_s = np.full(ROWS - 1, (1.0 + share) * ROW_S)
    steps_s[16:23] = ROW_S
    times = np.append(0.0, np.cumsum(steps_s))
    line = np.stack([times, 0.5 - 2.0 * times, 3.0 * times], axis=-1)
    trusted = ~np.isin(np.arange(ROWS), [17, 18, 19, 20])
    path = smoothed_earlier(line, times, [ROWS], 0.5 * ROW_S, trusted)
    assert path[20] == pytest.approx(
        np.interp(times[20] - 0.5 * ROW_S, times, line[:, 0]) * np.array([1.0, -2.0, 3.0]) + [0.0, 0.5, 0.0]
    )


def test_each_robot_and_each_row_may_have_a_delay_of_its_own():
    each = smoothed_earlier(parabola(TIMES), TIMES, [ROWS], np.array([[0.01], [0.03]]))
    np.testing.assert_allclose(each[1], smoothed_earlier(parabola(TIMES), TIMES, [ROWS], 0.03))
    growing = smoothed_earlier(parabola(TIMES), TIMES, [ROWS], 0.01 * TIMES)
    np.testing.assert_allclose(growing, parabola(0.99 * TIMES), atol=1e-9)
