"""Lamps of any size against the form factor of a rectangle, and light from all sides against that of a strip."""

import numpy as np
import pytest

from blender_scenes.hybrid.shadows.wide_lights import WideLamp, even_directions, lattice
from blender_scenes.scene.description import LightPanel

ABOVE_M, WIDTH_M, DEPTH_M = 0.8, 1.5, 1.0
"""Height and sides of a lamp whose corner is above the origin."""
LAMP = LightPanel(
    "lamp",
    (0.5 * WIDTH_M, 0.5 * DEPTH_M, ABOVE_M),
    (1.0, 0.0, 0.0),
    (0.0, -1.0, 0.0),
    WIDTH_M,
    DEPTH_M,
    (3.0, 2.0, 1.0),
)
FLOOR = np.zeros(3)


def _form_factor(width_m: float, depth_m: float) -> float:
    """Return that from a piece of the floor below a corner of a parallel rectangle (Howell, configuration B-3)."""
    a, b = width_m / ABOVE_M, depth_m / ABOVE_M
    one, other = a / np.hypot(1, a), b / np.hypot(1, b)
    angles = one * np.arctan(b / np.hypot(1, a)) + other * np.arctan(a / np.hypot(1, b))
    return float(angles / (2 * np.pi))


def test_a_lamp_gives_the_light_of_its_form_factor():
    """A white floor that sees nothing but the radiance L has the light L."""
    expected = np.array(LAMP.radiance) * _form_factor(WIDTH_M, DEPTH_M)
    assert WideLamp(LAMP, FLOOR, 0.1).light == pytest.approx(expected, rel=0.002)


@pytest.mark.parametrize("share", [0.2, 0.5, 0.8])
def test_the_points_of_a_lamp_have_equal_parts_of_its_light(share):
    points = WideLamp(LAMP, FLOOR, 0.1).points(400)
    assert points[:, 2] == pytest.approx(ABOVE_M)
    near = points[:, 0] < share * WIDTH_M
    assert near.mean() == pytest.approx(
        _form_factor(share * WIDTH_M, DEPTH_M) / _form_factor(WIDTH_M, DEPTH_M), abs=0.01
    )
    low = points[:, 1] < share * DEPTH_M
    assert low.mean() == pytest.approx(
        _form_factor(WIDTH_M, share * DEPTH_M) / _form_factor(WIDTH_M, DEPTH_M), abs=0.01
    )


def test_what_shines_upwards_or_lies_lower_than_what_moves_gives_no_light():
    up = LightPanel("up", LAMP.center, LAMP.right, (0.0, 1.0, 0.0), WIDTH_M, DEPTH_M, LAMP.radiance)
    for lamp in (WideLamp(up, FLOOR, 0.1), WideLamp(LAMP, FLOOR, 0.9)):
        assert not lamp.light.any()
        assert len(lamp.points(10)) == 0


@pytest.mark.parametrize("above_m", [0.5, 0.52, 0.53, 0.54])
def test_the_part_of_a_window_below_what_moves_is_left_out(above_m):
    """A point below it would throw its shadow to the other side."""
    window = LightPanel("window", (-2.0, 0.0, 1.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), 1.0, 2.0, (1.0, 1.0, 1.0))
    points = WideLamp(window, FLOOR, above_m).points(50)
    assert points[:, 0] == pytest.approx(-2.0)
    assert points[:, 2].min() > above_m


@pytest.mark.parametrize("slope_deg", [20.0, 45.0, 70.0])
def test_light_from_all_sides_comes_from_within_an_angle_of_a_plane_by_the_sine(slope_deg):
    """A strip without end that covers the angles up to `slope` on one side has half of the sine."""
    directions = even_directions(2000)
    angle = np.arctan2(directions[:, 0], directions[:, 2])
    inside = (angle > 0) & (angle < np.radians(slope_deg))
    assert inside.mean() == pytest.approx(0.5 * np.sin(np.radians(slope_deg)), abs=0.01)
    assert np.linalg.norm(directions[:, :3], axis=1) == pytest.approx(1.0)


def test_no_two_points_share_a_coordinate():
    for values in lattice(100):
        assert np.diff(np.sort(values)).min() > 0.003
        assert values.min() >= 0
        assert values.max() < 1
