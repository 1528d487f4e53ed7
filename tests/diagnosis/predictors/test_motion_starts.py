"""Functions of the motion since the robot started to drive or to turn, of paths whose sums are known."""

import numpy as np
import pytest

from diagnosis.predictors.pose.motion_starts import DISTANCES, start_covariates
from diagnosis.predictors.pose.reversals import BodyRate

ROW_S, ROWS = 0.05, 100
FAST_M_S = 0.2
ROW_M = ROW_S * FAST_M_S
EVERY_ROW = (np.arange(ROWS - 1), np.arange(1, ROWS))
STILL = BodyRate(np.zeros(ROWS), 1e-4)
ODD_ANY, EVEN_ANY, ODD_AGAINST, EVEN_AGAINST = range(4)
"""Sets of functions for one limit of slow motion: of any start, and of a start against the motion before."""


def functions_of(speed_m_s, trials=(ROWS,), windows=EVERY_ROW):
    """The sets of functions of the distance, for the larger limit of slow motion."""
    driving = BodyRate(np.asarray(speed_m_s, dtype=float), 1e-4)
    distance, turn = start_covariates((STILL, driving), np.full(ROWS, ROW_S), trials, windows)
    assert distance.name == "distance_since_start_m"
    assert turn.name == "turn_since_start_rad"
    return distance, distance.functions[4:]


def driven(*parts):
    """Speeds of successive parts, each of so many rows."""
    speeds = np.concatenate([np.full(rows, speed_m_s) for rows, speed_m_s in parts])
    assert len(speeds) == ROWS
    return speeds


def test_a_start_has_all_motion_within_a_distance_and_none_beyond():
    """After 10 rows at rest, the robot drives 1 cm in each row."""
    distance, sets = functions_of(driven((10, 0.0), (90, FAST_M_S)))
    for column, multiple in enumerate(DISTANCES):
        expected = np.zeros(ROWS - 1)
        expected[9 : 9 + int(multiple)] = ROW_M
        for which in (ODD_ANY, EVEN_ANY):
            np.testing.assert_allclose(sets[which][:, column], expected, atol=1e-12)
    # Nothing was driven before, so it is not against any motion.
    assert not sets[ODD_AGAINST].any()
    np.testing.assert_allclose(distance.values[[5, 10, 11, 20]], [0.0, 0.0, ROW_M, 10 * ROW_M], atol=1e-12)


def test_a_row_in_part_within_a_distance_counts_in_part():
    """At three quarters of the speed, the second row is within one row of the fast speed by a third."""
    _, sets = functions_of(driven((10, 0.0), (60, 0.75 * FAST_M_S), (10, 0.0), (20, FAST_M_S)))
    np.testing.assert_allclose(sets[ODD_ANY][9:12, 0], [0.75 * ROW_M, 0.25 * ROW_M, 0.0], atol=1e-12)


def test_a_start_the_other_way_is_against_the_motion_before_a_stop_and_one_the_same_way_is_not():
    _, sets = functions_of(driven((20, FAST_M_S), (20, 0.0), (20, FAST_M_S), (20, 0.0), (20, -FAST_M_S)))
    # A trial begins at rest.
    any_start, against = (np.flatnonzero(sets[which][:, 0]).tolist() for which in (ODD_ANY, ODD_AGAINST))
    assert any_start == [0, 39, 79]
    assert against == [79]
    assert sets[ODD_AGAINST][79, 0] == pytest.approx(-ROW_M)
    assert sets[EVEN_AGAINST][79, 0] == pytest.approx(ROW_M)


def test_no_start_reaches_into_the_next_trial():
    """The second trial drives the other way from its first row."""
    half = ROWS // 2
    _, sets = functions_of(np.repeat([FAST_M_S, -FAST_M_S], half), trials=(half, half))
    assert not sets[ODD_AGAINST].any()


def test_a_window_has_the_sum_of_its_rows():
    speeds = driven((10, 0.0), (40, FAST_M_S), (50, -FAST_M_S))
    first = np.arange(0, ROWS - 10, 5)
    _, rows = functions_of(speeds)
    _, windows = functions_of(speeds, windows=(first, first + 10))
    for by_row, by_window in zip(rows, windows, strict=True):
        np.testing.assert_allclose(by_window, [by_row[k : k + 10].sum(axis=0) for k in first], atol=1e-12)


@pytest.mark.parametrize(("share", "starts"), [(0.15, [49]), (0.25, [])])
def test_a_slow_motion_is_a_stop_up_to_a_fifth_of_the_fast_speed(share, starts):
    """Between two fast parts, the robot drives slowly in the same direction."""
    _, sets = functions_of(driven((30, FAST_M_S), (20, share * FAST_M_S), (50, FAST_M_S)))
    fast = np.flatnonzero(np.isclose(sets[ODD_ANY][:, 0], ROW_M)).tolist()
    assert [row for row in fast if row > 40] == starts
