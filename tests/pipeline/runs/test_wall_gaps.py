"""A wall with gaps of 0.20 m and 0.28 m: lost and found again, on the right one way and on the left the other."""

import itertools

import pytest

from configs.draw import draw_run
from configs.loader import load_scenario

RUNS = (1, 2, 3)


@pytest.fixture(scope="module")
def outcomes(begun):
    """By route and run."""
    scenario = load_scenario("wall_gaps")
    return {(route, run): begun(draw_run(scenario, route, run)) for route in ("East", "West") for run in RUNS}


@pytest.mark.parametrize("run", RUNS)
@pytest.mark.parametrize(("route", "wall", "lost"), [("East", 1, 44), ("West", 2, 33)])
def test_a_wall_is_lost_at_every_gap_and_found_again(route, wall, lost, run, outcomes):
    outcome = outcomes[route, run].result()
    assert outcome.problems == ()
    trajectory = outcome.recording.trajectory
    states = [state for state, _ in itertools.groupby(trajectory.state.tolist())]
    assert set(states) == {0, wall, lost}
    assert (states[0], states[-1]) == (0, 0)
    # Lost somewhere along each gap, and on the wall again before the next.
    x = trajectory.pose[trajectory.state == lost, 0]
    gaps = {"East": ((-0.5, -0.1), (0.15, 0.55)), "West": ((-0.35, 0.05), (0.3, 0.8))}[route]
    for low, high in gaps:
        assert ((x > low) & (x < high)).any()
    forward = trajectory.pose[-1, 0] - trajectory.pose[0, 0]
    assert abs(forward) > 2.4
