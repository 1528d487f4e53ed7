"""The last row that a thing reaches, by the closed form of a camera that looks level: cy + f h / depth."""

from dataclasses import replace

import pytest

from blender_scenes.hybrid.lowest_row import EdgesInSight
from blender_scenes.scene.description import Mesh
from blender_scenes.scene.meshes import block
from sensors.camera.views import FrameView, Moment
from symolo.core.geometry.pinhole import Intrinsics

CAMERA = Intrinsics(64, 48, 40.0, 40.0, 31.5, 23.5)
EYE_M = 0.2
AWAY = (9.0, 9.0, 0.0)


def _level(x_m: float, y_m: float = 0.0) -> tuple:
    """Looks along x of W."""
    return ((0.0, 0.0, 1.0, x_m), (-1.0, 0.0, 0.0, y_m), (0.0, -1.0, 0.0, EYE_M), (0.0, 0.0, 0.0, 1.0))


def _view(x_m: float = 0.0, y_m: float = 0.0, moving: tuple = AWAY) -> FrameView:
    return FrameView(1, 0.0, (x_m, y_m, 0.0), _level(x_m, y_m), (moving,))


def _box(x_m: float, y_m: float = 0.0) -> Mesh:
    """A decimetre wide and high, on the floor, its near side at x."""
    return block("box", (x_m + 0.05, y_m, 0.05), (0.1, 0.1, 0.1), "red")


def _row(depth_m: float, below_m: float = EYE_M) -> float:
    return 23.5 + 40.0 * below_m / depth_m


OBSTACLE = block("obstacle_M", (0.0, 0.0, 0.05), (0.1, 0.1, 0.1), "red")


@pytest.mark.parametrize("x_m", [0.4, 0.7, 2.0])
def test_a_box_reaches_down_to_its_near_edge_on_the_floor(x_m):
    sight = EdgesInSight(CAMERA, [_box(3.0), _box(x_m)], [OBSTACLE])
    assert 0 <= sight.lowest_row(_view()) - _row(x_m) < 1


@pytest.mark.parametrize("place", [(-1.0, 0.0), (1.0, 2.0), (1.0, -2.0), (0.25, 0.0)])
def test_what_is_behind_or_aside_or_below_is_not_in_sight(place):
    """The last, a plate on the floor, is too near."""
    thing = block("plate", (0.25, 0.0, 0.0), (0.1, 0.1, 0.001), "red") if place[0] == 0.25 else _box(*place)
    assert EdgesInSight(CAMERA, [thing], [OBSTACLE]).lowest_row(_view()) == -1


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_rail_along_the_way_is_seen_down_to_where_it_leaves_through_the_side(side):
    """Both its ends are out of sight. Its nearer edge is 0.2 m aside, and 34 px, the filter's reach with them."""
    rail = block("rail", (0.0, side * 0.201, 0.15), (8.0, 0.002, 0.001), "red")
    found = EdgesInSight(CAMERA, [rail], [OBSTACLE]).lowest_row(_view())
    assert 0 <= found - _row(40.0 * 0.2 / 34.0, EYE_M - 0.1495) < 1


def test_a_rail_that_leaves_through_the_bottom_is_seen_down_to_there():
    rail = block("rail", (0.0, 0.0, 0.05), (8.0, 0.002, 0.001), "red")
    assert EdgesInSight(CAMERA, [rail], [OBSTACLE]).lowest_row(_view()) == 48


def test_no_more_rows_are_returned_than_there_are():
    assert EdgesInSight(CAMERA, [_box(0.2)], [OBSTACLE]).lowest_row(_view()) == 48
    assert EdgesInSight(CAMERA, [], []).lowest_row(replace(_view(), moving=())) == -1


def test_a_moving_thing_counts_where_it_is():
    sight = EdgesInSight(CAMERA, [_box(3.0)], [OBSTACLE])
    assert 0 <= sight.lowest_row(_view(moving=(1.05, 0.0, 0.0))) - _row(1.0) < 1
    turned = _view(moving=(1.0, 0.0, 0.785398163))  # an eighth of a turn
    assert 0 <= sight.lowest_row(turned) - _row(1.0 - 0.05 * 2**0.5) < 1


def test_a_part_of_the_robot_is_where_the_robot_has_it():
    part = block("robot_part", (0.55, 0.0, 0.05), (0.1, 0.1, 0.1), "red")
    sight = EdgesInSight(CAMERA, [], [], [part])
    for x_m in (0.0, 3.0):
        assert 0 <= sight.lowest_row(replace(_view(x_m), moving=())) - _row(0.5) < 1


def test_all_moments_of_an_exposure_count():
    sight = EdgesInSight(CAMERA, [_box(1.0)], [OBSTACLE])
    moments = tuple(Moment((x, 0.0, 0.0), _level(x), (AWAY,)) for x in (0.0, 0.3, 0.6))
    assert 0 <= sight.lowest_row(replace(_view(), exposure=moments)) - _row(0.4) < 1
