"""Light without Blender against closed forms."""

import numpy as np
import pytest

from blender_scenes.lighting.illuminance import on_the_floor
from blender_scenes.preview.light import from_all_around, from_panels, from_sky, from_sun
from blender_scenes.preview.sun_shadow import SunShadow
from blender_scenes.preview.triangles import Triangles
from blender_scenes.scene.description import LightPanel, Sky, Sun
from blender_scenes.scene.meshes import block, floor
from sensors.camera.colour import LUMINANCE

LAMP = LightPanel("lamp", (0.3, -0.2, 2.0), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0), 0.3, 0.2, (8.0, 4.0, 2.0))
UP = np.array([[0.0], [0.0], [1.0]])


def below(distance_m, aside_m=0.0):
    return np.array([[0.3 + aside_m], [-0.2], [2.0 - distance_m]])


@pytest.mark.parametrize("aside_m", [0.0, 1.5, 4.0])
def test_far_from_a_lamp_the_inverse_square_holds(aside_m):
    point = below(20.0, aside_m)
    expected = on_the_floor([LAMP], tuple(point[:, 0].tolist()))
    assert from_panels([LAMP], point, UP)[:, 0] == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("distance_m", [0.001, 0.05, 0.3, 1.0])
def test_near_a_lamp_it_is_the_light_of_a_disc_of_its_area(distance_m):
    """On the axis of a Lambertian disc of radius R the illuminance is pi L R2 / (R2 + d2)."""
    squared_radius = LAMP.width_m * LAMP.height_m / np.pi
    expected = np.pi * np.array(LAMP.radiance) * squared_radius / (squared_radius + distance_m**2)
    assert from_panels([LAMP], below(distance_m), UP)[:, 0] == pytest.approx(expected, rel=1e-6)


def test_a_lamp_lights_neither_what_is_behind_it_nor_what_is_turned_away():
    assert from_panels([LAMP], below(-1.0), -UP).max() == 0
    assert from_panels([LAMP], below(1.0), -UP).max() == 0
    assert from_panels([], below(1.0), UP).max() == 0


def test_the_sun_lights_by_the_cosine_where_it_reaches():
    sun = Sun((0.0, np.cos(np.radians(30)), 0.5), (2.0, 1.0, 0.5), 0.01)
    normals = np.repeat(UP, 2, axis=1)
    light = from_sun(sun, normals, np.array([True, False]))
    np.testing.assert_allclose(light, [[1.0, 0.0], [0.5, 0.0], [0.25, 0.0]])
    assert from_sun(sun, -normals, np.array([True, True])).max() == 0


def test_all_around_is_the_light_of_an_integrating_sphere():
    """In a closed box of a square metre a side, each lumen ends as rho / (1 - rho) / 6 lux of what is passed on."""
    box = Triangles.from_meshes([block("box", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), "paint")], {"paint": 0})
    colors = np.tile([0.5, 0.75, 0.0], (12, 1))
    flux = np.pi * 0.06 * np.array(LAMP.radiance)
    expected = flux * np.array([1.0, 3.0, 0.0]) / 6.0
    assert from_all_around([LAMP], box, colors) == pytest.approx(expected)


def test_the_sky_has_the_luminance_of_its_panorama_whatever_its_saturation():
    for saturation in (0.0, 0.5, 1.0):
        sky = from_sky(Sky("forest", 0.0, 2.0, 10.0, saturation))
        assert sky @ LUMINANCE == pytest.approx(2.0 * np.array([1.0518, 1.1792, 1.3717]) @ LUMINANCE)


@pytest.mark.parametrize("elevation_deg", [20, 45, 70])
@pytest.mark.parametrize("azimuth_deg", [0, 100, 200])
def test_a_block_throws_a_shadow_as_long_as_its_height_over_the_tangent(elevation_deg, azimuth_deg):
    """Along a line through the middle of a round pillar's foot, as near as a square one of 0.1 m is round."""
    elevation, azimuth = np.radians([elevation_deg, azimuth_deg])
    level = np.array([np.cos(azimuth), np.sin(azimuth)])
    sun = Sun((*(np.cos(elevation) * level).tolist(), float(np.sin(elevation))), (1.0, 1.0, 1.0), 0.01)
    pillar = block("pillar", (0.0, 0.0, 0.25), (0.1, 0.1, 0.5), "paint")
    ground = floor("floor", (-2.0, -2.0), (2.0, 2.0), 0.0, "paint")
    shadow = SunShadow.from_scene(sun, Triangles.from_meshes([pillar, ground], {"paint": 0}))
    away = np.linspace(0.08, 1.9, 400)
    points = np.column_stack([-away[:, None] * level, np.zeros(len(away))])
    end = 0.5 / np.tan(elevation)
    up = np.tile(UP.T, (len(away), 1))
    lit = shadow.lit(points, up)
    assert not lit[away < end - 0.06].any()
    assert lit[away > end + 0.12].all()
    assert shadow.lit(-points * (1, 1, 0), up).all()
