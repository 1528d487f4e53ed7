"""Motion blur and rolling shutter in Cycles' light, against closed forms of a turning camera and a passing board."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from blender_scenes.scene.description import Scene, Sky, Sun
from blender_scenes.scene.meshes import block
from blender_scenes.scene.shading import Color, Surface
from sensors.camera.shutter import exposed, moment, window
from sensors.camera.views import FrameView
from symolo.arena.geometry import Box
from symolo.arena.obstacle_motion import ObstacleMotion
from symolo.core.geometry.lens import NO_DISTORTION, Coefficients
from symolo.core.geometry.pinhole import Intrinsics, Shutter
from symolo.core.geometry.robot_path import RobotPath

PIXELS, FOCAL_PX = 81, 100.0
RATE_RAD_S, SPEED_M_S = 3.0, 1.5
SHUTTER = Shutter(exposure_s=0.02, read_out_s=0.03)
X_RC = np.array([[0.0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 2.0], [0, 0, 0, 1]])
"""At the robot's middle, level, along its x."""

PASSING_S, TURNING_S = 1.0, 10.0
TIMES_S = np.array([0.0, 2.0, 9.9, 9.95, 10.0, 10.05, 10.1])
"""The robot stands up to the second of them, and turns from the third on."""
YAW_RAD = np.where(TIMES_S > 5, RATE_RAD_S * (TIMES_S - TURNING_S), 0.0)
PATH = RobotPath(
    TIMES_S,
    np.column_stack([0 * TIMES_S, 0 * TIMES_S, YAW_RAD]),
    np.column_stack([0 * TIMES_S, np.where(TIMES_S > 5, RATE_RAD_S, 0.0)]),
)
BOARD = Box("board", "obstacle", (1.0, 0.0, 2.0), (0.05, 2.0, 4.0), 0.0, "plastic")
"""Its near face 1 m away, its right edge at y = 0: at 1 s on its way to the left, from 3 s on at rest."""
WAY = ((1.0, -0.75, 0.0), (1.0, -0.75, 0.0), (1.0, 0.75, 0.0), (1.0, 0.0, 0.0))


ALL = slice(None)


def _traced(arena, light_of, focal_px: float, lens: Coefficients, views_of: slice = ALL) -> np.ndarray:
    """(N, P, P) how much of the board each pixel sees: turning, passing, and turning seen in an instant."""
    white = Surface("white", Color((0.8, 0.8, 0.8)), roughness=1.0, refractive_index=1.0)
    black = Surface("black", Color((0.0, 0.0, 0.0)), roughness=1.0, refractive_index=1.0)
    scene = Scene(
        surfaces=(white, black),
        meshes=(block("back", (3.0, 0.0, 2.0), (0.1, 9.0, 9.0), "black"),),
        robot=(),
        panels=(),
        sun=Sun((-1.0, 0.0, 0.0), (3.0,) * 3, np.radians(0.5)),
        sky=Sky("studio", 0.0, 0.0, 10.0, 1.0),
        moving=(block("board", (0.025, 1.0, 2.0), (0.05, 2.0, 4.0), "white"),),
    )
    moving = replace(arena, boxes=(replace(BOARD, motion=ObstacleMotion((0.0, 0.5, 1.5, 3.0), WAY, repeats=False)),))
    camera = Intrinsics(PIXELS, PIXELS, focal_px, focal_px, 40.0, 40.0, lens)
    views = []
    for number, t_s in enumerate((TURNING_S, PASSING_S)):
        at = moment(moving, X_RC, (0.0, 0.0, 0.0), t_s)
        views.append(FrameView(number, t_s, at.robot_pose, at.X_WC, at.moving))
    turning, passing = exposed(views, moving, X_RC, PATH, window(SHUTTER, camera))
    images = light_of(scene, [turning, passing, views[0]][views_of], PIXELS, focal_px, SHUTTER, lens)[..., 1]
    return images / images[:, :, 20:25].mean(axis=2, keepdims=True)


@pytest.fixture(scope="module")
def edges(arena, light_of) -> np.ndarray:
    return _traced(arena, light_of, FOCAL_PX, NO_DISTORTION)


def _fitted(edge: np.ndarray) -> tuple[float, float, float]:
    """Where the edge is in the middle row [px], how it shears [px a row], and the variance of its step [px^2]."""
    steps = -np.diff(edge, axis=1)
    between = np.arange(PIXELS - 1) + 0.5
    at = steps @ between
    slope, middle = np.polyfit(np.arange(PIXELS) - 40.0, at, 1)
    spread = (steps * (between - at[:, None]) ** 2).sum(axis=1)
    return middle, slope, spread.mean()


def test_an_instant_sees_the_edge_where_it_is(edges):
    middle, slope, _ = _fitted(edges[2])
    assert middle == pytest.approx(40.0, abs=0.05)
    assert slope == pytest.approx(0.0, abs=1e-3)


TURNING_PX_S, PASSING_PX_S = FOCAL_PX * RATE_RAD_S, -FOCAL_PX * SPEED_M_S


@pytest.mark.parametrize(("view", "px_s"), [(0, TURNING_PX_S), (1, PASSING_PX_S)])
def test_the_read_out_shears_the_edge_by_its_speed(edges, view, px_s):
    """By a turn to the left the edge moves to the right; the board itself moves to the left."""
    middle, slope, _ = _fitted(edges[view])
    assert middle == pytest.approx(40.0, abs=0.1)
    assert slope == pytest.approx(px_s * SHUTTER.read_out_s / PIXELS, rel=0.02)


def test_the_exposure_blurs_the_edge_by_its_speed(edges):
    # A box of length L has the variance L^2 / 12; to it comes that of the pixel, which is the same for both.
    blur_px = SHUTTER.exposure_s * np.array([TURNING_PX_S, PASSING_PX_S])
    (_, _, turning), (_, _, passing) = _fitted(edges[0]), _fitted(edges[1])
    assert turning - passing == pytest.approx((blur_px[0] ** 2 - blur_px[1] ** 2) / 12, rel=0.03)
    assert passing == pytest.approx(blur_px[1] ** 2 / 12, abs=0.3)


def test_behind_a_lens_each_row_is_exposed_at_its_own_time(arena, light_of):
    """A lens that brings the edge to other rows by 8 px, which are half a pixel of turn."""
    focal_px, lens = 60.0, (-0.35, 0.12, 0.0, 0.0, 0.0)
    steps = -np.diff(_traced(arena, light_of, focal_px, lens, slice(1))[0], axis=1)
    found = steps @ (np.arange(PIXELS - 1) + 0.5)
    K = np.array([[focal_px, 0, 40.0], [0, focal_px, 40.0], [0, 0, 1]])
    up = np.linspace(-0.95, 0.95, 400)
    expected = []
    for row in range(PIXELS):
        x = np.tan(RATE_RAD_S * SHUTTER.read_out_s * ((row + 0.5) / PIXELS - 0.5))
        edge = np.column_stack([np.full(400, x), up, np.ones(400)])
        pixels, _ = cv2.projectPoints(edge, np.zeros(3), np.zeros(3), K, np.array(lens))
        expected.append(np.interp(row, pixels[:, 0, 1], pixels[:, 0, 0]))
    assert found[1:-1] == pytest.approx(expected[1:-1], abs=0.2)
    assert np.polyfit(np.arange(PIXELS), found - expected, 1)[0] * PIXELS == pytest.approx(0.0, abs=0.1)


def test_behind_a_lens_the_margin_lengthens_the_window_and_the_middle_row_keeps_its_time():
    lens = Intrinsics(80, 60, 57.0, 57.0, 39.5, 29.5, (-0.3, 0.1, 0.0, 0.0, 0.0))
    plain, wide = (window(Shutter(0.01, 0.03), camera) for camera in (replace(lens, distortion=(0.0,) * 5), lens))
    assert plain.length_s == pytest.approx(0.04)
    assert wide.length_s > 0.045
    assert wide.row_share * wide.length_s == pytest.approx(0.01)
    assert wide.opens_s + 0.5 * wide.length_s == pytest.approx(-0.5 * 0.03 / 60)  # as Cycles counts rows by their end
    assert window(Shutter(0.01, 0.0), lens).opens_s == pytest.approx(-0.005)
