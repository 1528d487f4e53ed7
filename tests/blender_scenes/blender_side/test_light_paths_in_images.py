"""Light over many bounces against closed forms, under both presets of light paths."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from blender_scenes.render.job import RenderJob
from blender_scenes.render.light_paths import LIGHT_PATHS
from blender_scenes.render.sampling import TracingSettings
from blender_scenes.scene.description import LightPanel, Mesh, Point3, Scene, Sky
from blender_scenes.scene.meshes import block, floor
from blender_scenes.scene.shading import Color, Mix, Surface, Tiles
from blender_scenes.scene.solids import lathe
from configs.schema.appearance.look import CameraLook
from sensors.camera.response import CameraResponse
from sensors.camera.views import FrameView
from symolo.core.geometry.pinhole import Intrinsics
from symolo.dataset.layout import frame_name

NO_SKY = Sky("studio", 0.0, 0.0, 10.0, 1.0)
DOWN = ((1.0, 0.0, 0.0, 0.0), (0.0, -1.0, 0.0, 0.0), (0.0, 0.0, -1.0, 0.5), (0.0, 0.0, 0.0, 1.0))
UP = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.5), (0.0, 0.0, 0.0, 1.0))
AHEAD = ((0.0, 0.0, 1.0, 0.0), (-1.0, 0.0, 0.0, 0.0), (0.0, -1.0, 0.0, 0.5), (0.0, 0.0, 0.0, 1.0))
"""Along +x, 0.5 m above the origin."""
PIXELS, FOCAL_PX = 12, 100.0
FAR_M = 500.0
LAMP_M = 0.02
SPHERE_M, SPHERE_LAMP_M = 1.0, 0.1
ROOM_M = 4.0
AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
MIRRORED = LightPanel("lamp", (-1.0, 0.04, 0.53), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), 0.18, 0.12, (8.0, 4.0, 2.0))
"""Behind the camera; it shines towards the mirror at x = 1."""
CEILING_LAMP = LightPanel("lamp", (0.0, 0.0, 0.6), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), 0.5, 0.5, (4.0, 4.0, 4.0))
"""It shines up, to a mirror at z = 2."""


def _matt(name: str, reflectance: float) -> Surface:
    return Surface(name, Color((reflectance,) * 3), roughness=1.0, refractive_index=1.0)


GLOSSY = Surface("glossy", Color((1.0, 1.0, 1.0)), roughness=0.3)
COATED = Surface("coated", Color((0.5, 0.5, 0.5)), roughness=0.3, refractive_index=1.5)
METAL = Surface("metal", Color((0.9, 0.9, 0.9)), roughness=0.3, metallic=1.0)
MIRROR = Surface("mirror", Color((0.9, 0.9, 0.9)), roughness=0.0, metallic=1.0)
REFLECTOR = replace(MIRROR, name="reflector", encloses_lamp=True)
TILES = Tiles((0.1, 0.1), 0.05, 0.0, (0.0, 0.0), softness=0.01)
"""Three quarters of its area are joints."""
TILED = Surface(
    "tiled", Mix(TILES, Color((0.9, 0.9, 0.9)), Color((0.5, 0.5, 0.5))), roughness=1.0, refractive_index=1.0
)
SURFACES = (TILED, _matt("0.5", 0.5), _matt("0.7", 0.7), _matt("0.8", 0.8), GLOSSY, COATED, METAL, MIRROR, REFLECTOR)


def _scene(meshes: tuple[Mesh, ...], *panels: LightPanel) -> Scene:
    used = {name for mesh in meshes for name in mesh.face_surface}
    surfaces = tuple(surface for surface in SURFACES if surface.name in used)
    return Scene(surfaces, meshes, robot=(), panels=panels, sun=None, sky=NO_SKY)


def _floor(half_m: float, surface: str) -> Mesh:
    return floor("floor", (-half_m, -half_m), (half_m, half_m), 0.0, surface)


def _mirrored_lamp(mirror: str) -> tuple[Scene, tuple]:
    """Return a floor that has light only from a lamp in the mirror above it."""
    above = block("mirror", (0.0, 0.0, 2.5), (8.0, 8.0, 1.0), mirror)
    return _scene((_floor(0.1, "0.5"), above), CEILING_LAMP), DOWN


def _panel(height_m: float, side_m: float, radiance: float, *, shines_down: bool = True) -> LightPanel:
    up = (0.0, -1.0, 0.0) if shines_down else (0.0, 1.0, 0.0)
    return LightPanel("lamp", (0.0, 0.0, height_m), (1.0, 0.0, 0.0), up, side_m, side_m, (radiance,) * 3)


def _furnace() -> tuple[LightPanel, ...]:
    """Return six panels around a room, all of radiance 1."""
    panels = []
    for number, axis in enumerate(AXES):
        for sign in (1.0, -1.0):
            right, up = np.array(AXES[(number + 1) % 3]), -sign * np.array(AXES[(number + 2) % 3])
            center: Point3 = tuple((0.5 * ROOM_M * sign * np.array(axis)).tolist())
            panels.append(
                LightPanel(f"{number}{sign}", center, _point(right), _point(up), ROOM_M, ROOM_M, (1.0, 1.0, 1.0))
            )
    return tuple(panels)


def _point(vector: np.ndarray) -> Point3:
    x, y, z = vector.tolist()
    return x, y, z


def _body(surface: str) -> tuple[Scene, tuple]:
    return _scene((block("body", (0.0, 0.0, 0.0), (0.4, 0.4, 0.4), surface),), *_furnace()), DOWN


def _hollow_sphere(reflectance: str) -> tuple[Scene, tuple]:
    """Return an integrating sphere with a lamp in its middle that shines down, seen in its upper, unlit half."""
    latitude = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 33)[1:-1]
    profile = [(SPHERE_M * float(np.cos(a)), SPHERE_M * float(np.sin(a))) for a in latitude]
    mesh = lathe("sphere", profile, reflectance, sides=64)
    return _scene((mesh,), _panel(0.0, SPHERE_LAMP_M, 100.0)), UP


def _plates(ceiling: str) -> tuple[Scene, tuple]:
    """Return two large plates, 1 m apart, with even light from the upper to the lower one."""
    ceiling = block("ceiling", (0.0, 0.0, 1.5), (2 * FAR_M, 2 * FAR_M, 1.0), ceiling)
    return _scene((_floor(FAR_M, "0.7"), ceiling), replace(_panel(0.999, 2 * FAR_M, 1.0), seen=False)), DOWN


SCENES = {
    "matt body": _body("0.5"),
    "glossy body": _body("glossy"),
    "metal body": _body("metal"),
    "sphere 0.5": _hollow_sphere("0.5"),
    "sphere 0.8": _hollow_sphere("0.8"),
    "plates": _plates("0.8"),
    "coated plates": _plates("coated"),
    "tiled plates": _plates("tiled"),
    "even sky": (_scene((_floor(FAR_M, "0.5"),), _panel(1.0, 2 * FAR_M, 1.0)), DOWN),
    "lamp at 1 m": (_scene((_floor(1.0, "0.5"),), _panel(1.0, LAMP_M, 1000.0)), DOWN),
    "lamp at 2 m": (_scene((_floor(1.0, "0.5"),), _panel(2.0, LAMP_M, 1000.0)), DOWN),
    "lamp at 4 m": (_scene((_floor(1.0, "0.5"),), _panel(4.0, LAMP_M, 1000.0)), DOWN),
    "mirror": (_scene((block("mirror", (1.5, 0.0, 0.5), (1.0, 2.0, 2.0), "mirror"),), MIRRORED), AHEAD),
    "lamp above": (
        _scene((_floor(0.1, "0.5"),), replace(CEILING_LAMP, center=(0.0, 0.0, 3.4), up=(0.0, -1.0, 0.0))),
        DOWN,
    ),
    "lamp in a mirror above": _mirrored_lamp("mirror"),
    "lamp in its reflector": _mirrored_lamp("reflector"),
}


@pytest.fixture(scope="module")
def lights(lights_of_scenes: Callable[..., list[dict[str, np.ndarray]]]) -> dict[str, dict[str, np.ndarray]]:
    """Linear light (P, P, 3) of each scene, under each preset."""
    scenes = {name: (scene, [FrameView(1, 0.0, (50.0, 50.0, 0.0), X_WC)]) for name, (scene, X_WC) in SCENES.items()}
    lights = lights_of_scenes(scenes, PIXELS, FOCAL_PX, list(LIGHT_PATHS.values()))
    return {
        preset: {name: light[0] for name, light in of_preset.items()}
        for preset, of_preset in zip(LIGHT_PATHS, lights, strict=True)
    }


@pytest.fixture(params=LIGHT_PATHS)
def radiance(lights, request) -> Callable[[str], float]:
    """Mean radiance of a scene's image, under one of the presets."""
    return lambda scene: float(lights[request.param][scene].mean())


@pytest.mark.parametrize(("body", "reflectance"), [("matt", 0.5), ("glossy", 1.0), ("metal", 0.9)])
def test_a_convex_body_in_a_furnace_shines_with_its_reflectance(radiance, body, reflectance):
    """A white dielectric reflects everything, and so becomes invisible."""
    assert radiance(f"{body} body") == pytest.approx(reflectance, rel=0.02)


@pytest.mark.parametrize("reflectance", [0.5, 0.8])
def test_an_integrating_sphere_collects_the_light_of_all_bounces(radiance, reflectance):
    """Light that left the wall once reaches all of the wall evenly: E = (flux / area) r / (1 - r)."""
    flux = np.pi * 100.0 * SPHERE_LAMP_M**2
    illuminance = flux / (4 * np.pi * SPHERE_M**2) * reflectance / (1 - reflectance)
    assert radiance(f"sphere {reflectance}") == pytest.approx(reflectance / np.pi * illuminance, rel=0.02)


def test_two_parallel_plates_pass_light_to_each_other_again_and_again(radiance):
    """The lower plate has E = pi + 0.8 x 0.7 E, in light of radiance 1 from everywhere above."""
    assert radiance("plates") == pytest.approx(0.7 / (1 - 0.8 * 0.7), rel=0.02)


def _share_of_even_light(index: float) -> float:
    """Return the share of light from all directions that a dielectric reflects.

    Formula: Egan and Hilgeman, Optical Properties of Inhomogeneous Materials, 1979.
    """
    n, n2, n4 = index, index**2, index**4
    return (
        0.5
        + (n - 1) * (3 * n + 1) / (6 * (n + 1) ** 2)
        + n2 * (n2 - 1) ** 2 / (n2 + 1) ** 3 * math.log((n - 1) / (n + 1))
        - 2 * n**3 * (n2 + 2 * n - 1) / ((n2 + 1) * (n4 - 1))
        + 8 * n4 * (n4 + 1) / ((n2 + 1) * (n4 - 1) ** 2) * math.log(n)
    )


@pytest.mark.parametrize(("preset", "within"), [("complete", 0.015), ("standard", 0.028)])
def test_a_glossy_plate_passes_on_what_it_reflects_of_even_light(lights, preset, within):
    """The light from the matt plate below is even. `standard` has the gloss of one angle in place of all."""
    gloss = _share_of_even_light(1.5)
    reflectance = gloss + 0.5 * (1 - gloss)
    assert lights[preset]["coated plates"].mean() == pytest.approx(0.7 / (1 - reflectance * 0.7), rel=within)


def test_a_textured_plate_passes_on_as_much_light_as_a_plate_of_its_mean_colour(radiance):
    """A quarter of the ceiling reflects 0.9, and the joints 0.5."""
    assert radiance("tiled plates") == pytest.approx(0.7 / (1 - 0.6 * 0.7), rel=0.02)


def test_an_endless_floor_under_an_even_sky_has_the_radiance_of_the_sky_times_its_reflectance(radiance):
    assert radiance("even sky") == pytest.approx(0.5, rel=0.01)


def test_the_light_of_a_small_lamp_falls_with_the_square_of_its_distance(radiance):
    for distance_m in (1, 2, 4):
        illuminance = 1000.0 * LAMP_M**2 / distance_m**2
        assert radiance(f"lamp at {distance_m} m") == pytest.approx(0.5 / np.pi * illuminance, rel=0.01)


@pytest.mark.parametrize("preset", LIGHT_PATHS)
def test_a_mirror_shows_a_lamp_as_far_behind_it_as_the_lamp_is_before_it(lights, preset):
    light = lights[preset]["mirror"]
    depth_m = 3.0
    assert light.max(axis=(0, 1)) == pytest.approx(0.9 * np.array(MIRRORED.radiance), rel=0.01)
    width_px, height_px = FOCAL_PX * MIRRORED.width_m / depth_m, FOCAL_PX * MIRRORED.height_m / depth_m
    assert light.sum(axis=(0, 1)) == pytest.approx(0.9 * np.array(MIRRORED.radiance) * width_px * height_px, rel=0.02)
    grey = light.sum(axis=2)
    rows, columns = np.indices(grey.shape)
    middle = 0.5 * (PIXELS - 1)
    # The camera's right is -y, and its down is -z.
    expected = middle - FOCAL_PX / depth_m * np.array([MIRRORED.center[1], MIRRORED.center[2] - 0.5])
    measured = [float((at * grey).sum() / grey.sum()) for at in (columns, rows)]
    assert measured == pytest.approx(expected, abs=0.05)


def test_a_mirror_lights_the_floor_like_a_lamp_behind_it_if_caustics_are_followed(lights):
    behind = 0.9 * lights["complete"]["lamp above"].mean()
    assert lights["complete"]["lamp in a mirror above"].mean() == pytest.approx(behind, rel=0.03)


@pytest.mark.parametrize("preset", LIGHT_PATHS)
def test_the_reflector_of_a_lamp_lights_the_floor_under_every_preset(lights, preset):
    behind = 0.9 * lights["complete"]["lamp above"].mean()
    assert lights[preset]["lamp in its reflector"].mean() == pytest.approx(behind, rel=0.03)


def test_sixty_four_times_the_light_gives_the_same_image(images_of, tmp_path):
    """The limit on the light of a path follows the exposure: one in fixed units would darken the brighter scene."""
    wall = block("wall", (0.8, 0.0, 0.5), (0.1, 2.0, 1.0), "0.8")
    jobs = {}
    for times in (1.0, 64.0):
        scene = _scene((_floor(1.0, "0.5"), wall), _panel(1.0, 0.3, times))
        folder = tmp_path / str(times)
        folder.mkdir()
        jobs[folder] = _job(scene, FrameView(1, 0.0, (50.0, 50.0, 0.0), AHEAD))
    images_of(jobs)
    one, other = ((folder / "images" / frame_name(1)).read_bytes() for folder in jobs)
    assert one == other


def _job(scene: Scene, view: FrameView) -> RenderJob:
    middle = 0.5 * (PIXELS - 1)
    return RenderJob(
        format=RenderJob.FORMAT,
        scene=scene,
        camera=Intrinsics(PIXELS, PIXELS, 10.0, 10.0, middle, middle),
        frames=(view,),
        sampling=TracingSettings(seed=1, samples=8, denoise=False, paths=replace(LIGHT_PATHS["standard"], clamp=0.5)),
        response=CameraResponse.from_look(CameraLook(), (1.0, 1.0, 1.0), 1, 92),
    )
