"""When a lap counts as closed."""

import math

import pytest

from physics.run.lap import LapDetector

START = (0.55, -0.20, math.pi / 2)


def driven(*poses, on_track=True):
    lap = LapDetector(START)
    for pose in poses:
        lap.update(pose, on_track=on_track)
    return lap.closed


AWAY = (-0.6, 0.3, 3.0)
AT_THE_START = (0.55, -0.19, math.pi / 2)


def test_a_robot_that_comes_back_in_its_direction_closes_the_lap():
    assert driven(START, AWAY, AT_THE_START)


def test_whole_turns_do_not_matter():
    assert driven(START, AWAY, (0.55, -0.19, math.pi / 2 - 2 * math.pi))


def test_the_start_itself_is_no_lap():
    assert not driven(START, (0.55, -0.1, math.pi / 2), AT_THE_START)


@pytest.mark.parametrize(
    "pose",
    [
        (0.55, -0.21, math.pi / 2),  # not there yet
        (0.55, -0.19, -math.pi / 2),  # the wrong way
        (0.70, -0.19, math.pi / 2),  # beside the track
    ],
)
def test_other_poses_do_not_close_it(pose):
    assert not driven(START, AWAY, pose)


def test_a_robot_that_is_off_its_track_has_to_find_it_first():
    assert not driven(START, AWAY, AT_THE_START, on_track=False)
