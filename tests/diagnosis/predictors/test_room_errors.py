"""Errors of a room, by rays in a room whose walls stand elsewhere."""

import numpy as np
import pytest

from diagnosis.measured.case_files.nominal import KnownRoom
from diagnosis.measured.room_distances import WALLS, room_ranges
from diagnosis.predictors.ranges.room_errors import corners_m, room_errors, wall_errors, wall_place_m

X_M, Y_M, SMALL = 3.0, 2.0, 1e-6
ROOM = KnownRoom(room_x_m=X_M, room_y_m=Y_M)
MOUNT = (np.array([0.05, 0.02, 0.02]), np.array([0.0, 0.04, -0.04]), np.array([0.0, 0.9, -0.9]))
RNG = np.random.default_rng(3)
POSE = np.stack([RNG.uniform(0.3, 2.7, 200), RNG.uniform(0.3, 1.7, 200), RNG.uniform(-np.pi, np.pi, 200)], axis=-1)
SEEN = room_ranges(ROOM, POSE, *MOUNT)


def distance_to_line(corner, direction):
    """Distances (n, 3) along the axes to the line through a point, by the cross product."""
    yaw, (ahead, left, axis) = POSE[:, 2:], MOUNT
    x = POSE[:, :1] + np.cos(yaw) * ahead - np.sin(yaw) * left
    y = POSE[:, 1:2] + np.sin(yaw) * ahead + np.cos(yaw) * left
    along_x, along_y = np.cos(yaw + axis), np.sin(yaw + axis)
    off_x, off_y = corner[0] - x, corner[1] - y
    return (off_x * direction[1] - off_y * direction[0]) / (along_x * direction[1] - along_y * direction[0])


LINES = {
    # A point of the wall in its middle, its outward normal, and its direction from its lower to its higher coordinate.
    "x = 0": ((0.0, 0.5 * Y_M), (-1.0, 0.0), (0.0, 1.0), 0.5 * Y_M),
    "x = room_x_m": ((X_M, 0.5 * Y_M), (1.0, 0.0), (0.0, 1.0), 0.5 * Y_M),
    "y = 0": ((0.5 * X_M, 0.0), (0.0, -1.0), (1.0, 0.0), 0.5 * X_M),
    "y = room_y_m": ((0.5 * X_M, Y_M), (0.0, 1.0), (1.0, 0.0), 0.5 * X_M),
}


@pytest.mark.parametrize("wall", WALLS)
def test_ranges_change_as_the_wall_is_shifted_or_turned_about_its_middle(wall):
    middle, normal, direction, half_m = (np.array(part) for part in LINES[wall])
    changes = dict(wall_errors(ROOM, SEEN))
    hits = SEEN.wall == WALLS.index(wall)
    assert hits.sum() > 20
    before = distance_to_line(middle, direction)
    np.testing.assert_allclose(before[hits], SEEN.distance_m[hits], rtol=1e-9)
    shifted = distance_to_line(middle + SMALL * normal, direction)
    turned = distance_to_line(middle, direction + SMALL / half_m * normal)
    for what, after in ((f"shift of the wall {wall}", shifted), (f"turn of the wall {wall}", turned)):
        np.testing.assert_allclose(changes[what][hits], (after - before)[hits] / SMALL, rtol=1e-4, atol=1e-5)
        assert not changes[what][~hits].any()


def test_places_go_round_the_room_as_the_headings_do():
    """From the middle of the room, all around: a rising place, and that of a corner where the beam meets it."""
    assert corners_m(ROOM) == (0.0, 3.0, 5.0, 8.0, 10.0)
    toward = np.arctan2([-1.0, -1.0, 1.0, 1.0], [-1.5, 1.5, 1.5, -1.5])
    pose = np.stack([np.full(4, 1.5), np.full(4, 1.0), toward + 1e-6], axis=-1)
    place_m = wall_place_m(ROOM, room_ranges(ROOM, pose, *(np.zeros(1),) * 3))[:, 0]
    np.testing.assert_allclose(place_m, [0.0, 3.0, 5.0, 8.0], atol=1e-5)
    yaw = np.linspace(toward[0] + 1e-6, toward[0] + 2.0 * np.pi - 1e-6, 300)
    pose = np.stack([np.full(300, 1.5), np.full(300, 1.0), yaw], axis=-1)
    assert np.all(np.diff(wall_place_m(ROOM, room_ranges(ROOM, pose, *(np.zeros(1),) * 3))[:, 0]) > 0.0)


def test_all_sensors_have_the_same_errors():
    of_sensors = room_errors(ROOM, SEEN)
    names = [[(each.covariate, each.what) for each in errors] for errors in of_sensors]
    assert len(names[0]) == 2 * len(WALLS)
    assert names[0] == names[1] == names[2]
