"""Cycles' light against closed forms, and the exposure of the shipped looks."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from blender_scenes.render.job import FramePose, RenderJob, build_job
from blender_scenes.scene.description import LightPanel, Scene, Sky, Sun
from blender_scenes.scene.meshes import block, floor
from blender_scenes.scene.shading import Color, Surface
from configs.draw import draw_look
from configs.loader import load_section
from configs.references import shipped_names
from configs.schema.scenario import Render
from sensors.camera.views import FrameView

GREY = Surface("floor", Color((0.5, 0.5, 0.5)), roughness=1.0, refractive_index=1.0)
NO_SKY = Sky("studio", 0.0, 0.0, 10.0, 1.0)
LOOKING_DOWN = ((1.0, 0.0, 0.0, 0.0), (0.0, -1.0, 0.0, 0.0), (0.0, 0.0, -1.0, 0.5), (0.0, 0.0, 0.0, 1.0))
LOOKING_UP = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.5), (0.0, 0.0, 0.0, 1.0))


LAMP = LightPanel("lamp", (0.0, 0.0, 2.0), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0), 0.1, 0.2, (8.0, 4.0, 2.0))
LARGE_LAMP = replace(LAMP, width_m=1.0, height_m=1.0)
GAIN = (0.5, 0.75, 1.25)
SUN = Sun((0.0, np.cos(np.radians(30)), 0.5), (2.0, 1.0, 0.5), np.radians(0.5))
BLACK = Surface("floor", Color((0.0, 0.0, 0.0)), roughness=1.0, refractive_index=1.0)
GLASS = Surface("glass", Color((1.0, 1.0, 1.0)), roughness=0.02, refractive_index=1.52, transmission=1.0)
PANE = block("pane", (0.0, 0.0, 0.7), (2.0, 2.0, 0.006), "glass")
PANEL = replace(LAMP, center=(0.0, 0.0, 1.0), width_m=1.0, height_m=1.0, radiance=(0.4, 0.2, 0.1))
"""Above the pane of glass."""
UNSEEN_PANEL = replace(PANEL, seen=False)


def _scene(surface=GREY, panels=(), sun=None, sky=NO_SKY, *, pane=False) -> Scene:
    meshes = (floor("floor", (-1.0, -1.0), (1.0, 1.0), 0.0, "floor"), *((PANE,) if pane else ()))
    return Scene((surface, *((GLASS,) if pane else ())), meshes, robot=(), panels=panels, sun=sun, sky=sky)


def _views(X_WC, *gains):
    return [FrameView(1, 0.0, (5.0, 5.0, 0.0), X_WC, light_gain=gain) for gain in gains or ((1.0, 1.0, 1.0),)]


@pytest.fixture(scope="module")
def radiances(lights_of_scenes) -> dict[str, np.ndarray]:
    """Mean radiance (N, 3) of each view by the name of the scene, from 0.5 m above the origin of a floor."""
    glossy, bright = replace(GREY, refractive_index=1.45), Sky("studio", 0.0, 5.0, 10.0, 1.0)
    down, up = _views(LOOKING_DOWN), _views(LOOKING_UP)
    scenes = {
        "below a lamp": (_scene(panels=(LAMP,)), _views(LOOKING_DOWN, (1.0, 1.0, 1.0), GAIN)),
        "sun": (_scene(sun=SUN), down),
        "a lamp in sight": (_scene(panels=(replace(LARGE_LAMP, seen=True),)), up),
        "an unseen lamp": (_scene(panels=(replace(LARGE_LAMP, seen=False),)), up),
        "sky": (_scene(glossy, sky=bright), down),
        "glass below a lamp": (_scene(BLACK, (PANEL,), pane=True), up),
        "glass below an unseen lamp": (_scene(BLACK, (UNSEEN_PANEL,), pane=True), up),
        "floor below glass and a lamp": (_scene(GREY, (PANEL,), pane=True), down),
        "floor below glass and an unseen lamp": (_scene(GREY, (UNSEEN_PANEL,), pane=True), down),
    }
    (lights,) = lights_of_scenes(scenes, 5, 200.0)
    return {name: light.mean(axis=(1, 2)) for name, light in lights.items()}


def test_a_lamp_lights_the_floor_as_the_inverse_square_says(radiances):
    illuminance = np.array(LAMP.radiance) * 0.1 * 0.2 / 2.0**2
    assert radiances["below a lamp"][0] == pytest.approx(0.5 / np.pi * illuminance, rel=0.02)


def test_the_gain_of_a_frame_is_that_of_all_its_light(radiances):
    without, with_gain = radiances["below a lamp"]
    assert with_gain == pytest.approx(without * GAIN)


def test_the_sun_lights_the_floor_by_the_sine_of_its_elevation(radiances):
    assert radiances["sun"][0] == pytest.approx(0.5 / np.pi * 0.5 * np.array([2.0, 1.0, 0.5]), rel=0.02)


@pytest.mark.parametrize(
    ("name", "radiance"), [("a lamp in sight", LAMP.radiance), ("an unseen lamp", (0.0, 0.0, 0.0))]
)
def test_a_lamp_is_seen_as_bright_as_it_is_unless_something_else_is_seen_there(radiances, name, radiance):
    assert radiances[name][0] == pytest.approx(radiance)


def test_through_a_pane_of_glass_the_sky_is_seen_and_no_panel_beside_it(radiances):
    """Above a black floor, so that the pane has nothing to mirror; the panel still lights what lies below the pane."""
    # From the floor's middle to a metre's square a metre above it; a clear pane of index 1.52 lets 92 % through.
    view_factor, transmittance = 4 / np.pi * np.sqrt(0.2) * np.arctan(np.sqrt(0.2)), 0.92
    assert radiances["glass below a lamp"][0] == pytest.approx(PANEL.radiance, rel=0.15)
    assert radiances["glass below an unseen lamp"][0] == pytest.approx((0, 0, 0), abs=1e-3)
    below = radiances["floor below glass and an unseen lamp"][0]
    assert below == pytest.approx(radiances["floor below glass and a lamp"][0], rel=1e-3)
    assert below == pytest.approx(0.5 * view_factor * transmittance * np.array(PANEL.radiance), rel=0.06)


def test_the_sky_lights_nothing_because_its_windows_do(radiances):
    """Nor by way of the gloss: a ray thrown for it meets the sky, and must not bring light for the matt part too."""
    assert not radiances["sky"].any()


@pytest.fixture(scope="module")
def seen_in_looks(arena, robot, images_of, tmp_path_factory) -> dict[str, list[np.ndarray]]:
    """Grey images from three places in one draw of each shipped look."""

    def job_of(look: str) -> RenderJob:
        config, _ = draw_look(load_section("look", look, ["look.camera.exposure_time_s=0"]), 7, "exposure", 1)
        poses = [(0.55, -0.60, 90), (-0.60, 0.78, 182), (0.30, -1.04, 15)]
        frames = [FramePose(i + 1, 0.2 * i, x, y, float(np.radians(yaw))) for i, (x, y, yaw) in enumerate(poses)]
        return build_job(arena, robot, config, Render(width_px=48, height_px=36, samples=2), frames, seed=1)

    folders = {look: tmp_path_factory.mktemp(look) for look in shipped_names("look")}
    images_of({folder: job_of(look) for look, folder in folders.items()})
    return {
        look: [cv2.imread(str(path), cv2.IMREAD_GRAYSCALE) for path in sorted((folder / "images").iterdir())]
        for look, folder in folders.items()
    }


@pytest.mark.parametrize("look", shipped_names("look"))
def test_a_drawn_look_is_neither_black_nor_burnt(seen_in_looks, look):
    assert len(seen_in_looks[look]) == 3
    for grey in seen_in_looks[look]:
        assert 55 < np.median(grey) < 180
        assert np.mean(grey >= 250) < 0.05
        assert np.mean(grey <= 5) < 0.1
