"""Images and panoramas of the user's own, seen by Cycles and by the flat renderer where geometry says they are."""

import hashlib
import math
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from blender_scenes.materials import FLOORS
from blender_scenes.materials.base import SurfacePatch
from blender_scenes.preview.renderer import FlatRenderer
from blender_scenes.render.job import FramePose, RenderJob, build_job
from blender_scenes.scene.description import Scene, Sky, Sun
from blender_scenes.scene.meshes import floor
from blender_scenes.scene.run_scene import describe
from configs.schema.appearance.asset import Asset, ImageLook, SurfaceImages
from configs.schema.appearance.floors import FloorLook
from configs.schema.appearance.lighting import SkyLook
from configs.schema.appearance.look import LookConfig
from configs.schema.arena import ArenaConfig, LineConfig, WallConfig
from configs.schema.scenario import Render
from sensors.camera.views import FrameView
from symolo.arena.geometry import Arena
from symolo.core.geometry.pinhole import project

TILES = np.zeros((8, 12, 3), np.uint8)
"""Two rows of three tiles, blue first: above red, green, blue, below black, half of white's light, white."""
for _column, (_above, _below) in enumerate([((0, 0, 255), 0), ((0, 255, 0), 188), ((255, 0, 0), 255)]):
    TILES[:4, 4 * _column : 4 * _column + 4], TILES[4:, 4 * _column : 4 * _column + 4] = _above, _below
PNG = cv2.imencode(".png", TILES)[1].tobytes()
WHITE = 0.8
LIGHT = {(0, 0): (0, 0, 0), (1, 0): (0.5029,) * 3, (2, 0): (1, 1, 1)} | {
    (0, 1): (1, 0, 0),
    (1, 1): (0, 1, 0),
    (2, 1): (0, 0, 1),
}
"""Of each tile by column and row from the lower left; sRGB's 188 by IEC 61966-2-1."""
TILE_M, CORNER_M = 0.2, (0.07, -0.11)

HALL = np.zeros((16, 32, 3), np.float32)
"""Red first: the quarters of the horizon from x = -1 by y = 1 to x = 1 and on, above and below it."""
HALL[:8], HALL[8:] = np.repeat([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], 8, axis=0), 0.25


def _asset(name: str, data: bytes, size: tuple[int, int], mean: tuple[float, float, float]) -> Asset:
    sha256 = hashlib.sha256(data).hexdigest()
    return Asset(name=name, sha256=sha256, width_px=size[0], height_px=size[1], mean_rgb=mean)


TILES_FILE = _asset("tiles.png", PNG, (12, 8), (0.4171,) * 3)
HDR = cv2.imencode(".hdr", np.ascontiguousarray(HALL[..., ::-1]))[1].tobytes()
HALL_FILE = _asset("hall.hdr", HDR, (32, 16), (0.5, 0.5, 0.5))
IMAGE = ImageLook(
    file=TILES_FILE, width_m=3 * TILE_M, right_m=CORNER_M[0], up_m=CORNER_M[1], roughness=1.0, white_reflectance=WHITE
)
FLOOR = FloorLook(material="image", dirt=0.0, image=IMAGE)


@pytest.fixture(scope="module")
def user_files(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("own")
    for data in (PNG, HDR):
        (folder / hashlib.sha256(data).hexdigest()).write_bytes(data)
    return folder


def _middle(tile: tuple[int, int]) -> tuple[float, float]:
    return CORNER_M[0] + (tile[0] + 0.5) * TILE_M, CORNER_M[1] + (tile[1] + 0.5) * TILE_M


def _horizontal(number: int, heading_deg: float) -> FrameView:
    """From a metre above the origin, ten degrees upwards."""
    heading, up = math.radians(heading_deg), math.radians(10)
    right = np.array([math.sin(heading), -math.cos(heading), 0])
    ahead = np.array([math.cos(up) * math.cos(heading), math.cos(up) * math.sin(heading), math.sin(up)])
    X_WC = np.eye(4)
    X_WC[:3, :3] = np.stack([right, np.cross(ahead, right), ahead], axis=1)
    X_WC[2, 3] = 1.0
    return FrameView(number, 0.0, (99.0, 99.0, 0.0), tuple(tuple(row) for row in X_WC.tolist()))


SIDE_PX, HEIGHT_M = 48, 2.4
FOCAL_PX = 96.0
"""A pixel is HEIGHT_M / FOCAL_PX = 25 mm of the floor."""


@pytest.fixture(scope="module")
def traced(light_of, user_files) -> np.ndarray:
    """Light from above the floor in a sun that makes it the reflectance, and of the sky in four directions."""
    matt = replace(FLOORS["image"](FLOOR, SurfacePatch("floor", (9.0, 9.0), 1)), refractive_index=1.0)
    mesh = floor("floor", (-2.0, -2.0), (2.0, 2.0), 0.0, "floor")
    X_WC = ((1.0, 0.0, 0.0, 0.0), (0.0, -1.0, 0.0, 0.0), (0.0, 0.0, -1.0, HEIGHT_M), (0.0, 0.0, 0.0, 1.0))
    views = [FrameView(1, 0.0, (99.0, 99.0, 0.0), X_WC)]
    views += [_horizontal(2 + i, heading) for i, heading in enumerate((135, 45, -45, -135))]
    sky = Sky(HALL_FILE.sha256, 0.0, 2.0, 10.0, 1.0, HALL_FILE.mean_rgb)
    sun = Sun((0.0, 0.0, 1.0), (math.pi,) * 3, 0.01)
    scene = Scene((matt,), (mesh,), (), (), sun, sky)
    return light_of(scene, views, SIDE_PX, FOCAL_PX, user_files=user_files)


def test_cycles_shows_each_tile_in_its_place_at_its_size_and_as_bright_as_it_is(traced):
    """Every pixel whose square lies within one tile, over the whole of several repeats."""
    pixel_m = HEIGHT_M / FOCAL_PX
    across = (np.arange(SIDE_PX) - 0.5 * (SIDE_PX - 1)) * pixel_m
    x, y = np.meshgrid(across, -across)
    u, v = (x - CORNER_M[0]) / TILE_M, (y - CORNER_M[1]) / TILE_M
    colors = np.array([[LIGHT[column, row] for column in range(3)] for row in range(2)])
    expected = WHITE * colors[np.floor(v).astype(int) % 2, np.floor(u).astype(int) % 3]
    # Half a pixel, half of the image's own, within which colours run into each other, and the filter's width.
    edge = (pixel_m + 0.5 * TILE_M / 4) / TILE_M
    inside = np.minimum.reduce([u % 1, 1 - u % 1, v % 1, 1 - v % 1]) > edge
    assert 0.2 < inside.mean() < 0.6
    np.testing.assert_allclose(traced[0][inside], expected[inside], atol=0.012)


@pytest.mark.parametrize("quarter", range(4))
def test_cycles_shows_the_panorama_from_minus_x_by_plus_y_round(traced, quarter):
    """As Blender and most programs lay one out: its middle is +x, its left quarter +y; the gain is 2."""
    expected = [(2, 0, 0), (0, 2, 0), (0, 0, 2), (2, 2, 2)][quarter]
    middle = traced[1 + quarter, SIDE_PX // 2 - 3 : SIDE_PX // 2 + 3, SIDE_PX // 2 - 3 : SIDE_PX // 2 + 3]
    assert middle.mean(axis=(0, 1)) == pytest.approx(expected, abs=0.03)


@pytest.fixture(scope="module")
def job(robot) -> RenderJob:
    """Seen from the side of a wall in the same image."""
    wall = WallConfig(name="W", start=(0.45, -0.7), end=(0.45, 0.7), height_m=0.6, surface="wood")
    arena = Arena.from_config(ArenaConfig(name="one", line=LineConfig(), walls=(wall,)))
    own = IMAGE.model_copy(update={"right_m": 0.0, "up_m": 0.0})
    look = LookConfig(name="own", floor=FLOOR, images=SurfaceImages(wood=own), sky=SkyLook(panorama=HALL_FILE))
    frames = [FramePose(number=1, t_s=0.0, x_m=-0.3, y_m=0.0, yaw_rad=0.0)]
    return build_job(arena, robot, look, Render(width_px=160, height_px=120, samples=1), frames, seed=1)


def test_a_wall_with_an_image_is_to_the_range_sensors_what_it_was(job):
    wall = WallConfig(name="W", start=(0.9, -0.7), end=(0.9, 0.7), surface="wood")
    (box,) = Arena.from_config(ArenaConfig(name="one", line=LineConfig(), walls=(wall,))).boxes
    assert box.surface == "wood"
    assert {s.roughness for s in job.scene.surfaces if s.name.startswith("wall_W")} == {1.0}


def test_the_flat_renderer_shows_the_tiles_of_floor_and_wall_where_the_camera_sees_them(job, user_files):
    view, camera = job.frames[0], job.camera
    light = FlatRenderer(job, user_files).light(view, camera)
    on_floor = {tile: (*_middle(tile), 0.0) for tile in LIGHT if tile[0] < 2}  # the third column is behind the wall
    face_x = min(x for mesh in job.scene.meshes if mesh.name == "wall_W" for x, _, _ in mesh.vertices)
    # The face that is seen looks towards -x: from the robot's side its left end is at +y.
    on_wall = {(u % 3, 0): (face_x, 0.7 - (u + 0.5) * TILE_M, 0.04) for u in (2, 3, 4)}
    checked = []
    for places in (on_floor, on_wall):
        pixels, _ = project(camera, np.array(view.X_WC), np.array(list(places.values())))
        columns, rows = np.rint(pixels).astype(int).T
        shown = (columns > 1) & (columns < camera.width_px - 2) & (rows > 1) & (rows < camera.height_px - 2)
        for tile, column, row in zip(np.array(list(places))[shown], columns[shown], rows[shown], strict=True):
            seen, expected = light[row, column], np.array(LIGHT[tuple(tile)], float)
            np.testing.assert_array_equal(seen > 0.01 * np.median(light), expected > 0)
            checked.append((places is on_wall, *tile.tolist()))
    assert {(True, 0, 0), (True, 1, 0), (True, 2, 0)} <= set(checked)
    assert len(checked) >= 5


def test_a_user_image_that_is_missing_or_changed_is_refused(job, user_files, tmp_path):
    with pytest.raises(ValueError, match="is not in the workspace"):
        FlatRenderer(job, tmp_path)
    (tmp_path / TILES_FILE.sha256).write_bytes(HDR)
    with pytest.raises(ValueError, match="has changed since it was put there"):
        FlatRenderer(job, tmp_path)
    assert FlatRenderer(job, user_files).image(job.frames[0]).shape == (120, 160, 3)


def test_a_job_names_its_files_by_content_and_survives_its_file(job):
    text = job.to_json()
    assert RenderJob.from_json(text) == job
    assert {TILES_FILE.sha256, HALL_FILE.sha256} == set(_digests(text))


def _digests(text: str) -> list[str]:
    return [word for word in text.replace('"', " ").split() if len(word) == 64]


def test_the_window_shines_as_bright_as_the_look_asks_whatever_the_panoramas_scale(robot):
    """A file's unit is anything; 65 % of its mean luminance is what the window's panel has."""
    arena = Arena.from_config(ArenaConfig(name="none", line=LineConfig()))
    shone = []
    for scale in (0.01, 50.0):
        own = HALL_FILE.model_copy(update={"mean_rgb": (0.5 * scale, 0.6 * scale, 0.7 * scale)})
        look = LookConfig(name="own", sky=SkyLook(panorama=own, luminance_kcd_m2=2.0))
        scene = describe(arena, robot, look, 1)
        shone.append(next(panel.radiance for panel in scene.panels if panel.name == "window"))
    assert shone[0] == pytest.approx(shone[1])
    assert np.array(shone[0]) @ np.array([0.2126, 0.7152, 0.0722]) == pytest.approx(0.65 * 2.0)
