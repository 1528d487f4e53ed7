"""Prediction of shadows near what moves, against the angles that a bar without end hides from the floor."""

from dataclasses import replace

import numpy as np
import pytest

from blender_scenes.hybrid.floor.sight import FloorSight
from blender_scenes.hybrid.shadows.shadow_guide import ShadowGuide
from blender_scenes.scene.description import LightPanel, Mesh, Scene, Sky
from blender_scenes.scene.meshes import block
from sensors.camera.shutter import MOMENTS
from sensors.camera.views import FrameView, Moment
from symolo.core.arrays import FloatImage
from symolo.core.geometry.pinhole import Intrinsics

CAMERA = Intrinsics(120, 8, 300.0, 300.0, 59.5, 3.5)
PIXEL_M = 0.3 / 300.0
DOWN = ((0.0, -1.0, 0.0, 0.1), (-1.0, 0.0, 0.0, 0.0), (0.0, 0.0, -1.0, 0.3), (0.0, 0.0, 0.0, 1.0))
"""Pose of a camera 0.3 m above the floor that looks straight down on (0.1, 0); y falls along the rows."""
Y_M = -(np.arange(120) - 59.5) * PIXEL_M
LOW_M, HIGH_M, HALF_M = 0.02, 0.03, 0.01
BAR = block("bar", (0.1, 0.0, 0.5 * (LOW_M + HIGH_M)), (4.0, 2 * HALF_M, HIGH_M - LOW_M), "black")
"""It lies across the view and is wider than it."""
LAMP_Y_M, LAMP_Z_M, LAMP_M = 0.9, 1.5, 0.3
LAMP = LightPanel("lamp", (0.1, LAMP_Y_M, LAMP_Z_M), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0), LAMP_M, LAMP_M, (500.0,) * 3)
"""It is brighter than the light that is traced, as if furniture hid a part of it: all direct light counts as its."""
AWAY = (9.0, 9.0, 0.0)
STILL = (0.0, 0.0, 0.0)


def _scene(robot: tuple[Mesh, ...], moving: tuple[Mesh, ...] = ()) -> Scene:
    return Scene((), (), robot, (LAMP,), None, Sky("studio", 0.0, 0.0, 10.0, 1.0), moving=moving)


def _view(robot: tuple, moving: tuple = (), exposure: tuple[Moment, ...] = ()) -> FrameView:
    return FrameView(1, 0.0, robot, DOWN, moving, exposure=exposure)


def _share(scene: Scene, view: FrameView, off: tuple[str, ...] = ()) -> FloatImage:
    """Return (W, 3): red light is that of the lamp, blue light comes from all sides, green light is half of each."""
    size = 2, 30, 3
    straight, other = np.zeros(size, np.float32), np.zeros(size, np.float32)
    straight[..., :2] = other[..., 1:] = 0.5
    guide = ShadowGuide(scene, FloorSight(CAMERA, view, row_share=1.0))
    return guide.share(view, (straight, other), off).mean(axis=0)


def _union(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Return the length (...) that two intervals (2, ...) cover together."""
    both = np.maximum(high.min(axis=0) - np.maximum(*low), 0)
    return (high - low).sum(axis=0) - both


def _even(y_m: np.ndarray) -> np.ndarray:
    """Return the share of light from all sides: the bar hides the angles between its outermost corners."""
    corners = [(y, z) for y in (-HALF_M, HALF_M) for z in (LOW_M, HIGH_M)]
    sines = np.array([(y - y_m) / np.hypot(y - y_m, z) for y, z in corners])
    return 1 - 0.5 * (sines.max(axis=0) - sines.min(axis=0))


def _of_lamp(y_m: np.ndarray) -> np.ndarray:
    """Return the share of the lamp: lines over the bar's corners meet it at a place of its width."""
    corners = [(y, z) for y in (-HALF_M, HALF_M) for z in (LOW_M, HIGH_M)]
    at = np.array([y_m + (y - y_m) * LAMP_Z_M / z for y, z in corners])
    low, high = LAMP_Y_M - 0.5 * LAMP_M, LAMP_Y_M + 0.5 * LAMP_M
    hidden = np.clip(at.max(axis=0), low, high) - np.clip(at.min(axis=0), low, high)
    return 1 - hidden / LAMP_M


NEAR = np.abs(Y_M) < HALF_M + HIGH_M
"""Where the prediction counts in full."""


def assert_even(share: FloatImage) -> None:
    """Its points make steps of a few hundredths; a shape that is drawn has half a drawn pixel, 0.4 mm, on each side."""
    assert share == pytest.approx(_even(Y_M[NEAR]), abs=0.07)
    assert share.mean() == pytest.approx(_even(Y_M[NEAR]).mean(), abs=0.02)


@pytest.mark.parametrize("as_robot", [True, False], ids=["robot", "obstacle"])
def test_the_share_of_each_colour_is_that_of_the_lamp_and_of_light_from_all_sides(as_robot):
    scene = _scene((BAR,)) if as_robot else _scene((), (BAR,))
    share = _share(scene, _view(STILL, () if as_robot else (STILL,)))
    assert_even(share[NEAR, 2])
    # It rises by 0.25 from pixel to pixel.
    assert share[NEAR, 0] == pytest.approx(_of_lamp(Y_M[NEAR]), abs=0.13)
    assert share[NEAR, 0].mean() == pytest.approx(_of_lamp(Y_M[NEAR]).mean(), abs=0.02)
    assert share[NEAR, 0].min() < 0.05
    both = 0.5 * (share[NEAR, 0] + share[NEAR, 2])
    assert share[NEAR, 1] == pytest.approx(both, abs=1e-5)


TWO_LAMPS = (
    replace(LAMP, name="left", center=(0.1, -LAMP_Y_M, LAMP_Z_M)),
    replace(LAMP, name="right", center=(0.1, LAMP_Y_M, LAMP_Z_M)),
)


@pytest.mark.parametrize("apart_m", [0.0, 0.02, 0.03])
def test_of_each_light_what_neither_of_two_bodies_hides_is_let_through(apart_m):
    """A product of their shares would be right only if what they hide of a light were independent of each other.

    Bars at one place hide the same; beside each other they hide one part each, or each of them hides one of two lamps.
    """
    bars_y_m = np.array([-0.5, 0.5])[:, None] * apart_m
    scene = replace(_scene((BAR,), (BAR,)), panels=TWO_LAMPS)
    share = _share(scene, _view((0.0, bars_y_m[0, 0], 0.0), ((0.0, bars_y_m[1, 0], 0.0),)))
    near = np.abs(Y_M) < HALF_M + 0.5 * apart_m
    y_m, corners = Y_M[near] - bars_y_m, [(y, z) for y in (-HALF_M, HALF_M) for z in (LOW_M, HIGH_M)]
    sines = np.array([(y - y_m) / np.hypot(y - y_m, z) for y, z in corners])
    even = 1 - 0.5 * _union(sines.min(axis=0), sines.max(axis=0))
    at_m = np.array([Y_M[near] + (y - y_m) * LAMP_Z_M / z for y, z in corners])
    hidden = []
    for lamp_m in (-LAMP_Y_M, LAMP_Y_M):
        ends_m = [np.clip(end, lamp_m - 0.5 * LAMP_M, lamp_m + 0.5 * LAMP_M) for end in (at_m.min(0), at_m.max(0))]
        hidden.append(_union(*ends_m) / LAMP_M)
    for channel, expected in ((2, even), (0, 1 - np.mean(hidden, axis=0))):
        assert share[near, channel] == pytest.approx(expected, abs=0.2)
        assert share[near, channel].mean() == pytest.approx(expected.mean(), abs=0.025)


def test_a_lamp_whose_light_is_traced_apart_does_not_count():
    share = _share(_scene((BAR,)), _view(STILL), ("lamp",))
    for channel in range(3):
        assert_even(share[NEAR, channel])


def test_far_from_what_moves_all_light_is_let_through():
    assert _share(_scene((), (BAR,)), _view(STILL, (AWAY,))) == pytest.approx(1.0)
    assert _share(_scene(()), _view(STILL)) == pytest.approx(1.0)


def test_a_lamp_lower_than_a_body_that_is_not_in_sight_counts():
    tall = block("pillar", (0.0, 0.0, 1.0), (0.1, 0.1, 2.0), "black")
    beside = _share(_scene((BAR,), (tall,)), _view(STILL, (AWAY,)))
    np.testing.assert_array_equal(beside, _share(_scene((BAR,)), _view(STILL)))


def test_a_mesh_of_very_many_triangles_is_not_predicted():
    """It would have to be drawn for each point of each lamp."""
    faces = BAR.faces[1:]
    many = replace(BAR, faces=faces * 100, face_surface=BAR.face_surface[1:] * 100)
    assert _share(_scene((), (many,)), _view(STILL, (STILL,))) == pytest.approx(1.0)


def test_the_prediction_ends_without_a_step():
    short = block("box", (0.1, 0.02, 0.005), (0.02, 0.02, 0.01), "black")
    share = _share(_scene((short,)), _view(STILL))
    far = np.abs(Y_M - 0.02) > 0.01 + 2 * 0.01
    assert share[far] == pytest.approx(1.0)
    edge = np.abs(np.abs(Y_M - 0.02) - 0.03) < 0.004
    assert np.abs(np.diff(share, axis=0))[edge[1:]].max() < 0.03


def test_a_body_that_moves_during_the_exposure_is_taken_at_its_middle():
    """The pixels of a view are those at the middle of the exposure."""
    path = [(0.0, 0.02 * (i / (MOMENTS - 1) - 0.5), 0.0) for i in range(MOMENTS)]
    moments = tuple(Moment(STILL, DOWN, (pose,)) for pose in path)
    blurred = _share(_scene((), (BAR,)), _view(STILL, (STILL,), moments))
    assert blurred == pytest.approx(_share(_scene((), (BAR,)), _view(STILL, (STILL,))), abs=0.02)


def test_the_share_does_not_depend_on_the_views_before():
    scene = _scene((BAR,), (BAR,))
    views = [_view(STILL, (AWAY,)), _view(STILL, ((0.0, 0.03, 0.0),))]
    light = np.full((2, 30, 3), 0.5, np.float32)
    shares = []
    for order in (views, views[::-1]):
        guide = ShadowGuide(scene, FloorSight(CAMERA, views[0], row_share=1.0))
        shares.append([guide.share(view, (light, light), ()) for view in order])
    first, second = shares[0], shares[1][::-1]
    for one, other in zip(first, second, strict=True):
        np.testing.assert_array_equal(one, other)
