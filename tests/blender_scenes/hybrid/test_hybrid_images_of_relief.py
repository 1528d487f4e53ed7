"""Images from hybrid rendering of a floor with relief, whose light has half as many pixels each way, against full ones.

Two full images with other random numbers: the mean product of what an image differs by from one and from the other
is the square of its own error, free of their noise.
"""

from dataclasses import replace
from types import SimpleNamespace

import cv2
import numpy as np
import pytest

from blender_scenes.render.job import RenderJob
from blender_scenes.render.sampling import HYBRID_QUALITIES, HybridSamples, TracingSettings, hybrid_samples
from blender_scenes.scene.description import LightPanel, Scene, Sky
from blender_scenes.scene.meshes import block, floor, rectangle
from blender_scenes.scene.shading import Color, Constant, Mix, NoiseTexture, Step, Surface, SurfaceCoordinate, Tiles
from configs.schema.appearance.look import CameraLook
from configs.schema.robot import Camera
from configs.schema.scenario import Render
from sensors.camera.metering import median_luminance
from sensors.camera.response import CameraResponse, develop, encode_jpeg
from sensors.camera.views import FrameView
from symolo.core.geometry.pinhole import Intrinsics, floor_points, pose_X_RC, project
from symolo.core.geometry.poses import PlanarPose, pose_X_WR

pytestmark = pytest.mark.long
WIDTH_PX, HEIGHT_PX = 128, 96
CAMERA = Intrinsics(WIDTH_PX, HEIGHT_PX, 90.0, 90.0, 63.5, 47.5)
NEAR_WIDTH_PX = WIDTH_PX // 2
FULL_SAMPLES = 128
MOUNTED = Camera(
    x_m=0.05, y_m=0.0, height_above_base_m=0.25, pitch_down_deg=35.0, focal_length_mm=4.0, sensor_width_mm=5.7
)
X_RC = pose_X_RC(MOUNTED, base_height_m=0.0)
HERE = pose_X_WR(0.0, 0.0, 0.0) @ X_RC
RESPONSE = CameraResponse.from_look(CameraLook(), (1.0, 1.0, 1.0), 1, 92)


def _matt(name: str, red: float, green: float, blue: float) -> Surface:
    return Surface(name, Color((red, green, blue)), roughness=1.0, refractive_index=1.0)


JOINTS = Tiles((0.11, 0.11), 0.016, 0.0, (0.03, 0.052), "joint", softness=1.0)
WAVES = NoiseTexture((12.0, 12.0), (3.0, 5.0), octaves=1.0)
TILES = replace(_matt("floor", 0.4, 0.4, 0.4), height_m=0.01 * WAVES - 0.001 * JOINTS)
"""Of one colour, so that all that is seen of them is their relief; no slope beyond what light comes in at."""
LAMP = LightPanel("lamp", (0.4, 1.5, 1.0), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0), 0.4, 0.4, (15.0, 15.0, 13.0))
LINE_M = 0.04
TAPE = rectangle(
    "tape_0", [(x, y * LINE_M, 0.00013) for x, y in ((0, -0.5), (1.2, -0.5), (1.2, 0.5), (0, 0.5))], "black"
)
BOX = block("wall_A", (0.75, -0.22, 0.1), (0.1, 0.2, 0.2), "red")
OBSTACLE = block("obstacle_M", (0.0, 0.0, 0.06), (0.06, 0.06, 0.12), "green")
AT = (0.45, -0.12, 0.0)
AWAY = (-1.5, 1.5, 0.0)
SCENE = Scene(
    surfaces=(TILES, _matt("black", 0.03, 0.03, 0.03), _matt("red", 0.5, 0.08, 0.05), _matt("green", 0.05, 0.4, 0.08)),
    meshes=(floor("floor", (-0.5, -0.8), (1.2, 0.8), 0.0, "floor"), TAPE, BOX),
    robot=(block("chassis", (0.0, 0.0, 0.06), (0.16, 0.14, 0.1), "red"),),
    panels=(LAMP,),
    sun=None,
    sky=Sky("studio", 0.0, 0.2, 10.0, 1.0),
    moving=(OBSTACLE,),
)


def _view(number: int, moving: PlanarPose) -> FrameView:
    rows = tuple(tuple(row) for row in HERE.tolist())
    return FrameView(number, 0.0, (0.0, 0.0, 0.0), rows, (moving,))


def _job(hybrid: HybridSamples | None, seed: int, samples: int = FULL_SAMPLES) -> RenderJob:
    sampling = TracingSettings(seed=seed, samples=samples, denoise=False, hybrid=hybrid)
    views = _view(1, AT), _view(2, AWAY)
    return RenderJob(RenderJob.FORMAT, SCENE, CAMERA, views, sampling, RESPONSE)


@pytest.fixture(scope="module")
def images(lights_of) -> SimpleNamespace:
    """(2, H, W, 3) hybrid and full images, with the obstacle and without; (1, H, W, 3) another full image."""
    few = hybrid_samples(Render(quality="standard", width_px=WIDTH_PX, height_px=HEIGHT_PX))
    orders = [(_job(few, 1), 1, [1, 2]), (_job(None, 1), 1, [1, 2]), (_job(None, 2), 1, [1])]
    hybrid, full, again = lights_of(*orders, near_width_px=NEAR_WIDTH_PX)
    return SimpleNamespace(hybrid=hybrid, full=full, again=again)


NEAR = np.s_[0, 48:]
"""Rows of the first view in which a pixel sees no more than 9 mm of floor."""
LEFT, LINE, RIGHT = slice(4, 50), slice(48, 84), slice(90, 124)
"""Columns of bare floor, and of the line with some floor on either side."""
SPARE_M = 0.012
"""How far beyond the line its edge is looked for."""
SIDES = pytest.mark.parametrize("columns", [LEFT, RIGHT], ids=["left", "right"])


def _grey(image: np.ndarray, columns: slice) -> np.ndarray:
    return image[(*NEAR, columns)].mean(axis=-1)


@SIDES
def test_the_floor_is_as_bright_as_in_a_full_image(images, columns):
    hybrid, full = (image[(*NEAR, columns)].mean(axis=(0, 1)) for image in (images.hybrid, images.full))
    assert hybrid == pytest.approx(full, rel=0.01)


def test_the_line_is_where_it_is_in_a_full_image_and_as_wide(images):
    (middle, variance), (true_middle, true_variance) = (
        _middle_and_variance(_grey(image, LINE)) for image in (images.hybrid, images.full)
    )
    assert (middle - true_middle).mean() == pytest.approx(0.0, abs=0.1)
    assert np.abs(middle - true_middle).max() < 0.35
    assert variance.mean() == pytest.approx(true_variance.mean(), rel=0.05)


def _middle_and_variance(grey: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of what is dark about the line in each row [px, px^2]."""
    v, u = (index[(*NEAR[1:], LINE)] for index in np.indices((HEIGHT_PX, WIDTH_PX)))
    pixels = np.column_stack([u.ravel(), v.ravel()]).astype(float)
    about = np.abs(floor_points(CAMERA, HERE, pixels)[:, 1].reshape(u.shape)) < 0.5 * LINE_M + SPARE_M
    bright = np.ma.median(np.ma.masked_where(about, grey), axis=1).data[:, None]
    dark = (1 - grey / bright) * about
    total = dark.sum(axis=1)
    middle = (dark * u).sum(axis=1) / total
    return middle, (dark * (u - middle[:, None]) ** 2).sum(axis=1) / total


@SIDES
def test_relief_of_many_pixels_is_as_strong(images, columns):
    """The waves; joints, narrower than the blur, are left to the next test."""
    hybrid, full, again = (
        cv2.GaussianBlur(_relief(image, images.full, columns), (0, 0), 3.0)
        for image in (images.hybrid, images.full, images.again)
    )
    strength = (full * again).mean()
    assert np.sqrt(strength) > 0.05
    in_step = (hybrid * 0.5 * (full + again)).mean()
    assert in_step / strength == pytest.approx(1.0, abs=0.05)
    assert in_step / np.sqrt(strength * (hybrid**2).mean()) > 0.98


def _relief(image: np.ndarray, full: np.ndarray, columns: slice) -> np.ndarray:
    """Share by which each pixel is brighter than what is about it."""
    share = _grey(image, columns) / cv2.GaussianBlur(_grey(full, columns), (0, 0), 15.0)
    return share - share.mean()


@SIDES
def test_on_the_floor_the_error_is_no_larger_than_what_jpeg_adds(images, columns):
    """As `standard` promises: to an image with camera noise."""
    metered, clean = median_luminance(images.full), replace(RESPONSE, shot_noise=0.0, read_noise=0.0)
    hybrid, full, again = (
        develop(image[0], clean, metered, 1).astype(float)[(*NEAR[1:], columns)]
        for image in (images.hybrid, images.full, images.again)
    )
    noisy = encode_jpeg(develop(0.5 * (images.full[0] + images.again[0]), RESPONSE, metered, 1), 92)
    seen = cv2.cvtColor(cv2.imdecode(np.frombuffer(noisy, np.uint8), cv2.IMREAD_COLOR), cv2.COLOR_BGR2RGB)
    added = seen[(*NEAR[1:], columns)] - 0.5 * (full + again)
    assert ((hybrid - full) * (hybrid - again)).mean() < (added**2).mean()


# What moves


@pytest.mark.parametrize("away_m", [0.08, 0.1, 0.12])
def test_a_moving_obstacle_takes_its_shadow_along(images, away_m):
    towards = np.array(AT[:2]) - LAMP.center[:2]
    place = np.append(AT[:2] + away_m * towards / np.linalg.norm(towards), 0.0)
    ((u, v),) = np.rint(project(CAMERA, HERE, place[None])[0]).astype(int)
    there = np.s_[:, v - 1 : v + 2, u - 1 : u + 2]
    hybrid, full = (np.median(image[there], axis=(1, 2, 3)) for image in (images.hybrid, images.full))
    assert full[0] < 0.05 * full[1]
    assert hybrid[0] / hybrid[1] == pytest.approx(full[0] / full[1], abs=0.06)


@pytest.mark.parametrize(
    ("view", "rows", "columns"),
    [
        pytest.param(0, slice(28, 44), slice(84, 94), id="its dark face"),
        pytest.param(0, slice(26, 42), slice(82, 85), id="its bright face, 3 px wide"),
        pytest.param(0, slice(30, 45), slice(74, 80), id="the floor beside it"),
        pytest.param(0, slice(47, 50), slice(84, 94), id="the floor before it"),
        pytest.param(1, slice(3, 20), slice(84, 106), id="a box"),
        pytest.param(1, slice(10, 22), slice(72, 78), id="the floor beside the box"),
    ],
)
def test_light_does_not_run_from_one_surface_to_the_next(images, view, rows, columns):
    hybrid, full = (image[view, rows, columns].mean(axis=(0, 1)) for image in (images.hybrid, images.full))
    assert hybrid == pytest.approx(full, rel=0.05)


# Slopes


EVEN_SKY = LightPanel("lamp", (0.0, 0.0, 2.0), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0), 60.0, 60.0, (3.0, 3.0, 3.0))
HIGH = LightPanel("lamp", (1.7, 0.0, 1.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0), 0.4, 0.2, (15.0, 15.0, 15.0))
LOW_AHEAD = replace(HIGH, center=(1.7, 0.0, 0.3))
LOW_BEHIND = replace(HIGH, center=(-1.0, 0.0, 0.3), right=(0.0, 1.0, 0.0))


SLOPES = {
    "even sky, gentle": (EVEN_SKY, 0.25, 0.015),
    "even sky, steep": (EVEN_SKY, 0.5, 0.015),
    "high lamp, gentle": (HIGH, 0.1, 0.015),
    "high lamp, steep": (HIGH, 0.5, 0.04),
    "low lamp ahead, gentle": (LOW_AHEAD, 0.1, 0.07),
    "low lamp behind, gentle": (LOW_BEHIND, 0.1, 0.07),
}
"""Lamp, slope, and maximum error as a share of the light."""
COARSER = 2
"""The light of these lamps varies over decimetres."""


@pytest.fixture(scope="module")
def slopes(lights_of) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """By name (1, H, W, 3) from hybrid rendering, and in full, of ramps that rise ahead on the left and fall on the
    right."""
    jobs = []
    for lamp, slope, _ in SLOPES.values():
        rising = SurfaceCoordinate("u") * slope
        either_way = Mix(Step(SurfaceCoordinate("v"), -0.001, 0.001), rising, rising * Constant(-1.0))
        ramps = replace(_matt("floor", 0.2, 0.2, 0.2), height_m=either_way)
        scene = replace(SCENE, surfaces=(ramps,), meshes=(SCENE.meshes[0],), robot=(), moving=(), panels=(lamp,))
        view = replace(_view(1, AWAY), moving=())
        both = (_job(hybrid, 1, samples=16) for hybrid in (HYBRID_QUALITIES["standard"], None))
        jobs += [replace(job, scene=scene, frames=(view,)) for job in both]
    lights = lights_of(*((job, 1, None) for job in jobs), near_width_px=NEAR_WIDTH_PX, coarser=COARSER)
    return dict(zip(SLOPES, zip(lights[::2], lights[1::2], strict=True), strict=True))


@pytest.mark.parametrize("name", SLOPES)
def test_slopes_towards_light_and_away_are_as_bright_as_in_a_full_image(slopes, name):
    hybrid, full = ([_grey(image, columns).mean() for columns in (LEFT, RIGHT)] for image in slopes[name])
    _, _, off = SLOPES[name]
    assert hybrid == pytest.approx(full, abs=off * np.mean(full))


def test_all_light_is_finite_and_not_negative(images):
    assert np.isfinite(images.hybrid).all()
    assert images.hybrid.min() >= 0
