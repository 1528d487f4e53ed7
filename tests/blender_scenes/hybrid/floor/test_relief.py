"""Light on leaning floors, against the cosine of the angle to a lamp far away, and against sums of such lamps."""

import numpy as np
import pytest

from blender_scenes.hybrid.floor.relief import TILTS, lean, lean_from, lean_without, shading
from blender_scenes.hybrid.shadows.small_lights import SmallLamp
from blender_scenes.scene.description import LightPanel

SUN = (-0.6, -0.48, 0.64)
"""Direction to the sun; 40 degrees high, so it shines on every floor of the tests."""
REST = (0.48, 0.36, 0.8)
"""Direction of the rest of the light."""
NORMALS = np.array([[(0.0, 0.0, 1.0), (0.28, 0.0, 0.96), (-0.28, 0.0, 0.96), (0.0, 0.28, 0.96), (0.12, -0.16, 0.98)]])
NORMALS = (NORMALS / np.linalg.norm(NORMALS, axis=-1, keepdims=True)).astype(np.float32)
ON_LEVEL_FLOOR = np.array((0.7, 0.5, 0.2), np.float32)
"""Share of the sun in the light on a level floor, by colour."""


def _light_of(towards: tuple[float, float, float], normals: np.ndarray) -> np.ndarray:
    """Return the light (..., 1) of a lamp far away on some floors, as a share of that on a level floor."""
    return np.maximum(normals @ np.array(towards), 0)[..., None] / towards[2]


def _of_both(normals: np.ndarray) -> np.ndarray:
    """Return the light (..., 3) of the sun and of the rest, which is 1 on a level floor."""
    return ON_LEVEL_FLOOR * _light_of(SUN, normals) + (1 - ON_LEVEL_FLOOR) * _light_of(REST, normals)


LEANS = lean([_of_both(np.array(tilt)).reshape(1, 1, 3).astype(np.float32) for tilt in TILTS])


def _seen(hidden: np.ndarray) -> np.ndarray:
    """Return the light (1, 5, 3) on floors if so much of the light on a level floor (3,) is sunlight that is hidden."""
    shape = *NORMALS.shape[:2], 3
    taken = [(np.broadcast_to(hidden, shape), lean_from(np.array(SUN)))]
    leans = lean_without(np.broadcast_to(LEANS, (1, 5, 6)), taken)
    return (1 - hidden) * shading(NORMALS, leans)


def test_floors_in_all_light_have_the_light_of_sun_and_rest():
    assert shading(NORMALS, LEANS) == pytest.approx(_of_both(NORMALS), rel=1e-5)


@pytest.mark.parametrize("visible", [0.0, 0.4])
def test_floors_in_the_shadow_have_the_rest_of_the_light_and_the_sun_that_is_visible(visible):
    rest = (1 - ON_LEVEL_FLOOR) * _light_of(REST, NORMALS)
    expected = rest + visible * ON_LEVEL_FLOOR * _light_of(SUN, NORMALS)
    assert _seen((1 - np.float32(visible)) * ON_LEVEL_FLOOR) == pytest.approx(expected, rel=1e-5)


def test_floors_outside_of_the_shadow_have_exactly_the_same_light():
    assert (_seen(np.zeros(3, np.float32)) == shading(NORMALS, LEANS)).all()


def test_of_a_very_low_sun_the_part_that_tilted_floors_have_is_taken():
    """At 10 degrees it does not reach a floor that leans away from it by 15 degrees, nor does the map have it there."""
    low = float(np.cos(np.radians(10.0))), 0.0, float(np.sin(np.radians(10.0)))
    of_sun_alone = lean([_light_of(low, np.array(tilt)).repeat(3).astype(np.float32) for tilt in TILTS])
    assert lean_from(np.array(low)) == pytest.approx(of_sun_alone, rel=1e-6)
    assert lean_from(np.array(low))[0] < 1 / np.tan(np.radians(10.0))


def test_where_nearly_all_light_is_hidden_the_light_remains_finite():
    assert np.isfinite(_seen(np.full(3, np.float32(1 - 1e-6)))).all()


def test_the_light_of_a_lamp_leans_by_its_direction_from_each_place():
    lamp = LightPanel("lamp", (0.3, -0.2, 1.5), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0), 0.05, 0.05, (1.0,) * 3)
    places = np.array([[(0.3, -0.2), (0.0, 0.4)], [(-0.9, 0.1), (1.0, 1.0)]], np.float32)
    expected = (np.array((0.3, -0.2)) - places) / 1.5
    leans = SmallLamp(lamp).lean_at(places)
    assert leans == pytest.approx(np.repeat(expected, 3, axis=-1), abs=1e-5)


def test_what_several_lights_had_is_taken_from_all_light():
    """Half of the light comes straight from above, a quarter from each of two sides; without those it does not lean."""
    towards = (np.array((0.6, 0.0, 0.8)), np.array((0.0, 0.6, 0.8)))
    parts = [(np.full((1, 1, 3), 0.25, np.float32), lean_from(each)) for each in towards]
    both = sum(part.repeat(2, axis=-1) * its_lean for part, its_lean in parts)
    assert lean_without(both, parts) == pytest.approx(np.zeros((1, 1, 6)), abs=1e-6)
