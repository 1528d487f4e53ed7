"""Shadows of what moves on the floor: a point at the height h throws its own h / tan(elevation) away."""

from dataclasses import replace

import numpy as np
import pytest

from blender_scenes.hybrid.floor.sight import MIDDLE, FloorSight, filter_points
from blender_scenes.hybrid.shadows import body_shadows
from blender_scenes.hybrid.shadows.body_shadows import BodyShadows
from blender_scenes.hybrid.shadows.shadow_mask import shadow_mask
from blender_scenes.hybrid.shadows.small_lights import SmallLamp, SmallLight, SunDisc
from blender_scenes.scene.description import LightPanel, Mesh, Sun
from blender_scenes.scene.meshes import block
from configs.schema.robot import Camera
from sensors.camera.shutter import MOMENTS
from sensors.camera.views import FrameView, Moment
from symolo.core.geometry.pinhole import Intrinsics, pose_X_RC
from symolo.core.geometry.poses import pose_X_WR

ELEVATION = np.radians(30.0)
SUN = Sun((-float(np.cos(ELEVATION)), 0.0, float(np.sin(ELEVATION))), (1.0,) * 3, 0.009)
"""Its shadows lie along x."""
HALF_M, HEIGHT_M = 0.05, 0.1
SHADOW_M = HEIGHT_M / np.tan(ELEVATION)
BODY = block("body", (0.0, 0.0, 0.5 * HEIGHT_M), (2 * HALF_M, 2 * HALF_M, HEIGHT_M), "red")
EYE = tuple(tuple(row) for row in np.eye(4).tolist())


def _view(robot: tuple, moving: tuple = (), exposure: tuple[Moment, ...] = ()) -> FrameView:
    return FrameView(1, 0.0, robot, EYE, moving, exposure=exposure)


def _reached(shadows: BodyShadows, view: FrameView, x_m: float, y_m: float = 0.0, spare_m: float = 0.0) -> bool:
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
    shadows = BodyShadows(SunDisc(SUN), (BODY,), ())
    assert _reached(shadows, _view((1.0, 2.0, 0.0)), 1.0 + x_m, 2.0 + y_m) == reached
    assert _reached(shadows, _view((1.0, 2.0, 0.0)), 1.0 + x_m, 2.0 + y_m, spare_m=0.004)


def test_obstacles_and_all_moments_of_the_exposure_count():
    shadows = BodyShadows(SunDisc(SUN), (), (BODY,))
    away, moments = (9.0, 9.0, 0.0), (Moment((0.0, 0.0, 0.0), EYE, ((x_m, 0.0, 0.0),)) for x_m in (0.0, 1.0))
    view = _view(away, (away,), tuple(moments))
    assert [_reached(shadows, view, x_m) for x_m in (0.1, 0.5, 1.1)] == [True, False, True]


def test_floor_that_no_pixel_sees_is_not_reached():
    assert not _reached(BodyShadows(SunDisc(SUN), (BODY,), ()), _view((0.0, 0.0, 0.0)), np.nan)


CAMERA = Intrinsics(120, 6, 300.0, 300.0, 59.5, 2.5)
PIXEL_M = 0.3 / 300.0
DOWN = ((0.0, -1.0, 0.0, 0.1), (-1.0, 0.0, 0.0, 0.05), (0.0, 0.0, -1.0, 0.3), (0.0, 0.0, 0.0, 1.0))
"""Pose of a camera 0.3 m above the floor that looks straight down on (0.1, 0.05); y falls along the rows."""
Y_M = 0.05 - (np.arange(120) - 59.5) * PIXEL_M
WIDE_SUN = replace(SUN, towards=(0.0, -SUN.towards[0], SUN.towards[2]), angular_diameter_rad=0.04)
"""It shines along -y."""


def _share(light: SmallLight, view: FrameView, *bodies: Mesh) -> np.ndarray:
    """(W,): how much of the light reaches the floor along y, through the middle of each body of the view."""
    sight = FloorSight(CAMERA, view, row_share=1.0)
    everywhere = np.ones((6, 120), bool)
    shadows = BodyShadows(light, (), bodies or (BODY,))
    return shadows.visible_share(view, sight, [(filter_points(1.5), everywhere)], slice(0, 6)).mean(axis=0)


def _down(moving: tuple, exposure: tuple[Moment, ...] = ()) -> FrameView:
    return FrameView(1, 0.0, (0.0, 0.0, 0.0), DOWN, moving, exposure=exposure)


def test_the_shadow_lets_nothing_through_and_ends_at_the_upper_edge():
    share = _share(SunDisc(replace(SUN, angular_diameter_rad=0.001)), _down(((0.02, 0.0, 0.0),)))
    assert share[np.abs(Y_M) < HALF_M - 2 * PIXEL_M] == pytest.approx(0.0, abs=1e-6)
    assert share[Y_M > HALF_M + 2 * PIXEL_M] == pytest.approx(1.0)
    assert (1 - share[Y_M > 0]).sum() * PIXEL_M == pytest.approx(HALF_M, abs=0.2 * PIXEL_M)


def test_the_border_is_as_wide_as_the_disc_of_the_sun_throws_it():
    """Its standard deviation is that of a disc across, half of the radius, times h / sin(elevation)^2."""
    y_m, share = Y_M, _share(SunDisc(WIDE_SUN), _down(((0.1, 0.1 + SHADOW_M, 0.0),)))
    order = np.argsort(y_m)
    rise = -np.diff(share[order])
    middles = 0.5 * (y_m[order][1:] + y_m[order][:-1])
    end_m = 0.1 - HALF_M
    assert rise.sum() == pytest.approx(1.0, abs=0.01)
    assert (rise * middles).sum() == pytest.approx(end_m, abs=0.0005)
    spread_m = 0.5 * np.tan(0.02) * HEIGHT_M / np.sin(ELEVATION) ** 2
    assert np.sqrt((rise * (middles - end_m) ** 2).sum()) == pytest.approx(spread_m, rel=0.1)


LAMP_M, LAMP_SIZE_M = 0.8, 0.06
LAMP = LightPanel("lamp", (0.1, 0.05, LAMP_M), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0), 0.01, LAMP_SIZE_M, (1.0,) * 3)
"""It shines straight down on the middle of the view."""


@pytest.mark.parametrize("yaw", [0.0, np.pi / 2])
def test_the_shadow_of_a_lamp_spreads_from_the_lamp_and_has_the_border_of_its_size(yaw):
    """By similar triangles; a strip of even light, twelfth part of the square of its width, is the variance across."""
    body_y_m = 0.05 - HALF_M - 0.04
    share = _share(SmallLamp(LAMP), _down(((0.1, body_y_m, yaw),)))
    order = np.argsort(Y_M)
    y_m = Y_M[order]
    rise, middles = np.diff(share[order]), 0.5 * (y_m[1:] + y_m[:-1])
    above = middles > body_y_m
    # Near the lamp the lower edge ends the shadow and far from it the upper one; the face towards the lamp ends here.
    assert rise[above].sum() == pytest.approx(1.0, abs=0.01)
    assert (rise * middles)[above].sum() == pytest.approx(body_y_m + HALF_M, abs=0.001)
    far = _share(SmallLamp(LAMP), _down(((0.1, 0.05 + 0.02 - HALF_M, yaw),)))[order]
    rise = np.diff(far)[middles > 0.05]
    beyond = middles[middles > 0.05]
    end_m = 0.05 + 0.02 * LAMP_M / (LAMP_M - HEIGHT_M)
    assert (rise * beyond).sum() == pytest.approx(end_m, abs=0.001)
    spread_m = LAMP_SIZE_M * HEIGHT_M / (LAMP_M - HEIGHT_M) / np.sqrt(12)
    assert np.sqrt((rise * (beyond - end_m) ** 2).sum()) == pytest.approx(spread_m, rel=0.15)


def test_two_bodies_at_one_place_throw_the_shadow_of_one():
    place = (0.1, 0.05 - HALF_M - 0.02, 0.0)
    wide = SmallLamp(replace(LAMP, height_m=0.2))
    alone, both = (_share(wide, _down((place,) * n), *(BODY,) * n) for n in (1, 2))
    assert ((alone > 0.2) & (alone < 0.8)).sum() > 3
    assert both == pytest.approx(alone, abs=1e-6)


@pytest.mark.parametrize("count", [1, 2])
def test_behind_the_border_of_what_moves_during_the_exposure_no_light_is_left(count):
    """Bodies at one place move by 20 pixels; in their frame, floor is seen that no pixel sees in the middle of it."""
    long = block("body", (0.0, 0.0, 0.5 * HEIGHT_M), (2 * HALF_M, 0.4, HEIGHT_M), "red")
    places = [(0.1, 0.05 - 0.2 + shift_m, 0.0) for shift_m in np.linspace(-0.01, 0.01, MOMENTS)]
    moments = tuple(Moment((0.0, 0.0, 0.0), DOWN, (place,) * count) for place in places)
    share = _share(SmallLamp(LAMP), _down((places[2],) * count, moments), *(long,) * count)
    border = np.abs(Y_M - 0.05) < 0.02
    assert ((share > 0.2) & (share < 0.8)).sum() > 10
    assert (np.diff(share[border]) <= 1e-6).all()
    assert share[Y_M < 0.03] == pytest.approx(0.0, abs=1e-6)
    assert share[Y_M > 0.07] == pytest.approx(1.0, abs=1e-6)


def test_a_gap_between_two_bodies_lets_through_the_piece_of_the_lamp_that_is_seen_through_it():
    """Each body hides one side of the lamp, so what is left is no product, which would be 7 % more.

    The gap is the widest one from all of which the lamp's edges are hidden.
    """
    gap_m = 0.004
    places = [(0.1, 0.05 + side * (HALF_M + 0.5 * gap_m), 0.0) for side in (-1, 1)]
    share = _share(SmallLamp(LAMP), _down(tuple(places)), BODY, BODY)
    # By similar triangles, and half a drawn pixel less on each side of the gap.
    seen_m = (gap_m - 0.25 * 0.75 * PIXEL_M) * LAMP_M / HEIGHT_M
    assert share.sum() * PIXEL_M == pytest.approx(gap_m * seen_m / LAMP_SIZE_M, rel=0.03)


TALL_M = 0.4
TALL = block("body", (0.0, 0.0, 0.5 * TALL_M), (0.1, 2.0, TALL_M), "red")
EDGE_M, LAMP_X_M = 0.2, -1.4
"""Where the shadow of its upper edge lies across the view, and where the lamps are."""
AHEAD = Intrinsics(160, 120, 113.4, 113.4, 79.5, 59.5)
MOUNTED = Camera(
    x_m=0.05, y_m=0.0, height_above_base_m=0.07, pitch_down_deg=30.0, focal_length_mm=30.0, sensor_width_mm=42.33
)
X_WC = pose_X_WR(0.0, 0.0, 0.0) @ pose_X_RC(MOUNTED, base_height_m=0.05)
TILT = np.radians(40.0)
TILTED = (float(np.cos(TILT)), 0.0, -float(np.sin(TILT)))
"""Side of a lamp that shines backwards, away from the camera: its front is lower than its back."""


def _lamp(height_m: float, size_m: float, right: tuple[float, float, float] = (1.0, 0.0, 0.0)) -> SmallLamp:
    up = tuple(np.cross(right, (0.0, 0.0, 1.0)) / np.hypot(*right[:2]))
    return SmallLamp(LightPanel("lamp", (LAMP_X_M, 0.0, height_m), right, up, size_m, size_m, (1.0,) * 3))


@pytest.mark.parametrize(
    "light",
    [
        _lamp(2.5, 0.3),
        _lamp(1.1, 0.07),
        _lamp(2.5, 0.3, right=TILTED),
        _lamp(2.5, 0.3, right=(0.5**0.5, 0.5**0.5, 0.0)),
        SunDisc(replace(SUN, angular_diameter_rad=0.04)),
    ],
    ids=["wide lamp", "desk lamp", "tilted lamp", "lamp with a corner ahead", "sun"],
)
def test_all_shade_lies_where_a_shadow_is_expected(light):
    """The other rows of an image are taken as fully lit, so the border of a shadow would be cut off along a row."""
    x, _, z, far = light.corners().mean(axis=0)
    front_m = EDGE_M - TALL_M * (EDGE_M * far - x) / z
    view = FrameView(1, 0.0, (0.0, 0.0, 0.0), tuple(map(tuple, X_WC.tolist())), ((front_m - 0.05, 0.0, 0.0),))
    sight = FloorSight(AHEAD, view, row_share=0.0)
    shadows = BodyShadows(light, (), (TALL,))
    filters = [(filter_points(1.5), np.ones((120, 160), bool))]
    share = shadows.visible_share(view, sight, filters, slice(0, 120))
    reached = shadows.may_reach(view, sight.points(view, MIDDLE), 2 * sight.pixel_m()[1])
    assert (share[reached] < 0.5).any()
    assert share[~reached] == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("right", [(1.0, 0.0, 0.0), TILTED])
def test_the_border_of_a_lamps_shadow_ends_where_one_side_of_the_lamp_throws_the_upper_edge(right):
    """By similar triangles."""
    size_m, height_m = 0.3, 2.5
    shadows = BodyShadows(_lamp(height_m, size_m, right), (), (TALL,))
    ends_m = []
    for side in (-0.5, 0.5):
        x_m, z_m = LAMP_X_M + side * size_m * right[0], height_m + side * size_m * right[2]
        ends_m.append((z_m * HALF_M - TALL_M * x_m) / (z_m - TALL_M))
    at = _view((9.0, 9.0, 0.0), ((0.0, 0.0, 0.0),))
    assert [_reached(shadows, at, max(ends_m) + more_m) for more_m in (-0.001, 0.001)] == [True, False]


def test_the_border_of_a_moving_shadow_is_blurred_over_its_path():
    path_m = 0.02
    poses = [(0.02, path_m * (i / (MOMENTS - 1) - 0.5), 0.0) for i in range(MOMENTS)]
    moments = tuple(Moment((0.0, 0.0, 0.0), DOWN, (pose,)) for pose in poses)
    share = _share(SunDisc(replace(SUN, angular_diameter_rad=0.001)), _down((poses[MOMENTS // 2],), moments))
    expected = np.clip((Y_M - (HALF_M - 0.5 * path_m)) / path_m, 0, 1)
    # Nine moments of the exposure make steps of a ninth.
    assert share[Y_M > 0] == pytest.approx(expected[Y_M > 0], abs=0.12)
    assert (1 - share[Y_M > 0]).sum() * PIXEL_M == pytest.approx(HALF_M, abs=0.2 * PIXEL_M)


def test_a_body_out_of_sight_and_a_scene_without_bodies_shade_nothing():
    view = _down(((5.0, 5.0, 0.0),))
    assert _share(SunDisc(SUN), view) == pytest.approx(np.ones(120))


def test_a_mesh_of_many_triangles_is_drawn_for_fewer_points_of_the_sun(monkeypatch):
    """A mesh of a user may have 20,000 triangles, and this border is 16 pixels wide."""
    drawn = []

    def counted(shapes, directions, *rest):
        drawn.append(len(shapes) * len(directions))
        return shadow_mask(shapes, directions, *rest)

    monkeypatch.setattr(body_shadows, "shadow_mask", counted)
    # A body without one of its faces is not drawn as a whole.
    many, faces = 20_000 // len(BODY.faces), BODY.faces[1:]
    mesh = replace(BODY, faces=faces * many, face_surface=BODY.face_surface[1:] * many)
    view = _down(((0.1, 0.1 + SHADOW_M, 0.0),))
    share, of_many = (_share(SunDisc(WIDE_SUN), view, body) for body in (BODY, mesh))
    assert drawn[0] == 32
    assert drawn[1] <= 200_000
    # Ten points make steps of a tenth and more.
    assert of_many == pytest.approx(share, abs=0.15)
