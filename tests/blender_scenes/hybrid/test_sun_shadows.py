"""Where shadows of what moves lie on the floor: a point at the height h throws its own h / tan(elevation) away."""

import numpy as np
import pytest

from blender_scenes.hybrid.sun_shadows import SunShadows, visible_share
from blender_scenes.scene.description import Sun
from blender_scenes.scene.meshes import block
from sensors.camera.views import FrameView, Moment

ELEVATION = np.radians(30.0)
SUN = Sun((-float(np.cos(ELEVATION)), 0.0, float(np.sin(ELEVATION))), (1.0,) * 3, 0.009)
"""Its shadows lie along x."""
HALF_M, HEIGHT_M = 0.05, 0.1
SHADOW_M = HEIGHT_M / np.tan(ELEVATION)
BODY = block("body", (0.0, 0.0, 0.5 * HEIGHT_M), (2 * HALF_M, 2 * HALF_M, HEIGHT_M), "red")
EYE = tuple(tuple(row) for row in np.eye(4).tolist())


def _view(robot: tuple, moving: tuple = (), exposure: tuple[Moment, ...] = ()) -> FrameView:
    return FrameView(1, 0.0, robot, EYE, moving, exposure=exposure)


def _reached(shadows: SunShadows, view: FrameView, x_m: float, y_m: float = 0.0, spare_m: float = 0.0) -> bool:
    ground, spare = np.array([[[x_m, y_m]]], np.float32), np.array([[spare_m]], np.float32)
    return bool(shadows.may_reach(view, ground, spare)[0, 0])


@pytest.mark.parametrize(
    ("x_m", "y_m", "reached"),
    [
        (HALF_M + SHADOW_M - 0.002, 0.0, True),
        (HALF_M + SHADOW_M + 0.002, 0.0, False),
        (-HALF_M - 0.002, 0.0, False),
        (0.1, HALF_M - 0.002, True),
        (0.1, HALF_M + 0.002, False),
    ],
)
def test_a_shadow_begins_at_the_foot_and_ends_where_the_upper_edge_throws_it(x_m, y_m, reached):
    shadows = SunShadows(SUN, (BODY,), ())
    assert _reached(shadows, _view((1.0, 2.0, 0.0)), 1.0 + x_m, 2.0 + y_m) == reached
    assert _reached(shadows, _view((1.0, 2.0, 0.0)), 1.0 + x_m, 2.0 + y_m, spare_m=0.004)


def test_obstacles_and_all_moments_of_the_exposure_count():
    shadows = SunShadows(SUN, (), (BODY,))
    away, moments = (9.0, 9.0, 0.0), (Moment((0.0, 0.0, 0.0), EYE, ((x_m, 0.0, 0.0),)) for x_m in (0.0, 1.0))
    view = _view(away, (away,), tuple(moments))
    assert [_reached(shadows, view, x_m) for x_m in (0.1, 0.5, 1.1)] == [True, False, True]


def test_floor_that_no_pixel_sees_is_not_reached():
    assert not _reached(SunShadows(SUN, (BODY,), ()), _view((0.0, 0.0, 0.0)), np.nan)


def test_the_share_of_the_sun_is_that_of_both_lights_and_where_no_ray_meets_it_that_of_the_neighbours():
    still = np.ones((9, 9, 3), np.float32)
    still[4, 6] = 0.0
    moved = still.copy()
    moved[:, 4:] = 0.0
    moved[:, 3] *= 0.25
    share = visible_share(moved, still)[..., 0]
    assert share == pytest.approx(np.tile(share[:1], (9, 1)), abs=1e-6)
    assert share[0, [0, 1, 6, 8]] == pytest.approx([1.0, 1.0, 0.0, 0.0], abs=0.001)
    assert share[0].sum() == pytest.approx(3.25)
    assert visible_share(0 * still, 0 * still) == pytest.approx(np.ones((9, 9, 1)))
