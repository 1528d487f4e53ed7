"""Images from hybrid rendering against those that are traced in full, in linear light, in one Blender process."""

from dataclasses import replace

import numpy as np
import pytest

from blender_scenes.render.job import FramePose, RenderJob, build_job
from blender_scenes.render.sampling import HybridSamples, TracingSettings
from blender_scenes.scene.description import LightPanel, Mesh, Point3, Scene, Sky
from blender_scenes.scene.meshes import block, floor, rectangle
from blender_scenes.scene.shading import Color, Mix, NoiseTexture, Step, Surface, SurfaceCoordinate
from configs.draw import draw_look
from configs.loader import load_section
from configs.references import shipped_names
from configs.schema.appearance.look import CameraLook
from configs.schema.scenario import Render
from sensors.camera.response import CameraResponse
from sensors.camera.views import INSTANT, FrameView, Moment
from symolo.core.geometry.pinhole import Intrinsics, Shutter, floor_points, project
from symolo.core.geometry.poses import PlanarPose, pose_X_WR
from symolo.core.geometry.robot_path import RobotPath

WIDTH_PX, HEIGHT_PX = 64, 48
CAMERA = Intrinsics(WIDTH_PX, HEIGHT_PX, 45.0, 45.0, 31.5, 23.5)
WIDE = Intrinsics(320, 8, 225.0, 225.0, 159.5, 3.5)
"""Of so few rows that its light cannot share them four by four."""
LENS = replace(CAMERA, width_px=65, height_px=49, cx_px=33.0, cy_px=23.0, distortion=(-0.25, 0.05, 0.0, 0.0, 0.0))
"""With odd numbers of pixels."""
HYBRID = HybridSamples(near=4, far=2, surfaces=16)
SHADE_SAMPLES, FULL_SAMPLES, FEWER_SAMPLES = 256, 128, 64
"""Of full images: where few pixels in a shadow, single rows of pixels and means over regions count."""
COARSER = 4
"""The texels of the light maps, 16 mm wide, are so about as long as a pixel of these small images on the floor."""
PITCH = np.radians(35.0)
X_RC = np.array(
    [
        [0.0, -np.sin(PITCH), np.cos(PITCH), 0.05],
        [-1.0, 0.0, 0.0, 0.0],
        [0.0, -np.cos(PITCH), -np.sin(PITCH), 0.25],
        [0.0, 0.0, 0.0, 1.0],
    ]
)
ROLLING = Shutter(exposure_s=0.01, read_out_s=0.03)
GLOBAL = Shutter(exposure_s=0.02)
RATE_RAD_S = 6.0
AWAY = (3.0, 3.0, 0.0)


def _matt(name: str, red: float, green: float, blue: float) -> Surface:
    return Surface(name, Color((red, green, blue)), roughness=1.0, refractive_index=1.0)


MOTTLED = Mix(NoiseTexture((30.0, 30.0), (0.3, 0.7)), Color((0.5, 0.45, 0.4)), Color((0.3, 0.3, 0.3)))
FLOOR = Surface("floor", MOTTLED, roughness=0.6)
BEGINS_M, ENDS_M = 0.62, 0.72
"""Of a glossy strip across a rough floor, along x; 2.6 px wide."""
_STRIP = Step(SurfaceCoordinate("u"), BEGINS_M, BEGINS_M + 0.001) - Step(SurfaceCoordinate("u"), ENDS_M, ENDS_M + 0.001)
TAPED = Surface("floor", Color((0.6, 0.6, 0.6)), roughness=0.9 - 0.65 * _STRIP)
STRIPES = Surface(
    "back", Mix(Step(SurfaceCoordinate("v"), 0.3, 0.31), Color((0.2, 0.5, 0.2)), Color((0.5, 0.2, 0.2))), roughness=1.0
)
MIRROR = Surface("mirror", Color((0.9, 0.9, 0.9)), roughness=0.02, metallic=1.0)
GLASS = Surface("glass", Color((1.0, 1.0, 1.0)), roughness=0.0, refractive_index=1.5, transmission=1.0)
BLACK, RED, GREEN = _matt("black", 0.03, 0.03, 0.03), _matt("red", 0.5, 0.08, 0.05), _matt("green", 0.05, 0.4, 0.08)
LAMP = LightPanel("lamp", (0.9, 0.8, 2.0), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0), 0.4, 0.4, (6.0, 6.0, 5.0))
BEHIND = LightPanel("behind", (-0.7, -0.2, 0.6), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0), 0.1, 0.1, (60.0, 60.0, 60.0))
"""Low behind the robot, whose shadow so falls into the image."""


def _tape(name: str, corners: list[tuple[float, float]]) -> Mesh:
    return rectangle(name, [(x, y, 0.00013) for x, y in corners], "black")


LINE = _tape("tape_0", [(0.0, -0.02), (1.2, -0.02), (1.2, 0.02), (0.0, 0.02)])
ACROSS = _tape("tape_1", [(0.33, -0.5), (0.37, -0.5), (0.37, -0.06), (0.33, -0.06)])
ROBOT = block("chassis", (0.0, 0.0, 0.06), (0.16, 0.14, 0.1), "red")
BULB = LightPanel("bulb", (0.6, 0.1, 0.1), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0), 0.02, 0.02, (50.0, 50.0, 40.0), seen=True)
"""A pixel and a half wide, seen by the camera before the floor."""
BUMPER = block("robot_bumper", (0.2, 0.0, 0.04), (0.06, 0.14, 0.02), "green")
OBSTACLE = block("obstacle_M", (0.0, 0.0, 0.06), (0.06, 0.06, 0.12), "green")


def _scene(*walls: Mesh, ground: Surface = FLOOR) -> Scene:
    meshes = (floor("floor", (-0.6, -0.8), (1.2, 0.8), 0.0, "floor"), LINE, ACROSS, *walls)
    return Scene(
        surfaces=(ground, STRIPES, MIRROR, GLASS, BLACK, RED, GREEN),
        meshes=meshes,
        robot=(ROBOT,),
        panels=(LAMP, BEHIND),
        sun=None,
        sky=Sky("studio", 0.0, 0.2, 10.0, 1.0),
        moving=(OBSTACLE,),
    )


def _with_sheet(scene: Scene) -> Scene:
    """Return the scene with a red sheet of paper on its floor, which is a face of the floor's mesh."""
    ground, *others = scene.meshes
    corners = [(x, y, 0.00005) for x, y in ((0.25, 0.1), (0.75, 0.1), (0.75, 0.45), (0.25, 0.45))]
    sheet = rectangle("sheet", corners, "red")
    first = len(ground.vertices)
    both = replace(
        ground,
        vertices=(*ground.vertices, *sheet.vertices),
        faces=(*ground.faces, *(tuple(first + corner for corner in face) for face in sheet.faces)),
        face_surface=(*ground.face_surface, *sheet.face_surface),
        uv_m=(*ground.uv_m, *sheet.uv_m),
    )
    return replace(scene, meshes=(both, *others))


TAPED_WITH_BULB = replace(_scene(ground=TAPED), panels=(LAMP, BEHIND, BULB))
"""The bulb shines away from the strip."""
SHEET_WITH_BUMPER = replace(_with_sheet(_scene()), robot_in_sight=(BUMPER,))


def _at(number: int, pose: PlanarPose, moving: PlanarPose = AWAY) -> FrameView:
    return FrameView(number, 0.0, pose, _rows(pose), (moving,))


def _rows(pose: PlanarPose) -> tuple:
    return tuple(tuple(row) for row in (pose_X_WR(*pose) @ X_RC).tolist())


def _turning(number: int, length_s: float) -> FrameView:
    """On the spot, for the whole of a window around straight ahead."""
    yaws = RATE_RAD_S * length_s * np.linspace(-0.5, 0.5, 5)
    moments = tuple(Moment((0.0, 0.0, yaw), _rows((0.0, 0.0, yaw)), (AWAY,)) for yaw in yaws.tolist())
    return replace(_at(number, (0.0, 0.0, 0.0)), exposure=moments)


def _job(
    scene: Scene,
    views: list[FrameView],
    hybrid: HybridSamples | None,
    shutter: Shutter = INSTANT,
    samples: int = FULL_SAMPLES,
) -> RenderJob:
    sampling = TracingSettings(seed=1, samples=samples, denoise=False, hybrid=hybrid)
    response = CameraResponse.from_look(CameraLook(), (1.0, 1.0, 1.0), 1, 92)
    return RenderJob(RenderJob.FORMAT, scene, CAMERA, tuple(views), sampling, response, shutter)


NEEDLE = block("wall_N", (0.36, 0.03, 0.15), (0.003, 0.003, 0.3), "black")
"""A third of a pixel wide, so that light of few pixels may miss it."""
BOX = block("wall_A", (0.75, -0.22, 0.1), (0.1, 0.2, 0.2), "back")
STILL = [
    _at(1, (0.0, 0.0, 0.0)),
    _at(2, (0.0, 0.0, 0.0), (0.5, 0.15, 0.4)),
    _at(3, (0.0, 0.0, 0.0), (0.45, -0.12, 0.0)),
]
"""The obstacle away, on the left, and on the right."""


@pytest.fixture(scope="module")
def images(lights_of) -> dict[str, np.ndarray]:
    """Of each name (N, H, W, 3): 'hybrid' and 'full' of what a kind of scene shows, and one job in three ways."""
    seen = _scene(BOX)
    behind = _scene(block("wall_G", (0.5, 0.0, 0.15), (0.01, 0.6, 0.3), "glass"))
    before = _scene(block("wall_M", (0.6, 0.0, 0.15), (0.02, 0.6, 0.3), "mirror"))
    rolling, at_once = [_turning(1, ROLLING.exposure_s + ROLLING.read_out_s)], [_turning(1, GLOBAL.exposure_s)]
    kinds = {
        "still": (seen, STILL, INSTANT),
        "at once": (seen, at_once, GLOBAL),
        "rolling": (seen, rolling, ROLLING),
        "glass": (behind, STILL[:1], INSTANT),
        "mirror": (before, STILL[:1], INSTANT),
        "taped": (TAPED_WITH_BULB, STILL[:1], INSTANT),
        "sheet": (SHEET_WITH_BUMPER, STILL[:1], INSTANT),
    }
    still = _job(seen, STILL, HYBRID)
    names, orders = ["two threads", "of few rows"], [(still, 2, [3, 2])]
    orders.append((replace(_job(seen, STILL[:1], HYBRID), camera=WIDE), 1, [1]))
    for kind, hybrid in (("hybrid", HYBRID), ("full", None)):
        names.append(f"lens {kind}")
        orders.append((replace(_job(seen, STILL[:1], hybrid), camera=LENS), 1, [1]))
    for name, (scene, views, shutter) in kinds.items():
        for kind, hybrid in (("hybrid", HYBRID), ("full", None)):
            names.append(f"{name} {kind}")
            samples = SHADE_SAMPLES if name == "still" else FULL_SAMPLES if scene is seen else FEWER_SAMPLES
            orders.append((_job(scene, views, hybrid, shutter, samples), 1, [view.number for view in views]))
    return dict(zip(names, lights_of(*orders, coarser=COARSER), strict=True))


@pytest.fixture(scope="module")
def shared(lights_of) -> dict[str, np.ndarray]:
    """(N, H, W, 3) hybrid images, most of whose light has half as many pixels each way, the upper rows' as many."""
    still = _job(_scene(BOX), [*STILL, _at(4, (0.35, 0.1, 0.5))], HYBRID)
    # As many samples as the light of the whole image has, with which it is compared.
    as_many = replace(HYBRID, far=HYBRID.near)
    rolling = _job(_scene(BOX), [_turning(1, ROLLING.exposure_s + ROLLING.read_out_s)], as_many, ROLLING)
    orders = {
        "still": (still, 1, [1, 2, 3, 4]),
        "two threads": (still, 2, [4, 2]),
        "rolling": (rolling, 1, [1]),
        "taped": (_job(TAPED_WITH_BULB, STILL[:1], HYBRID), 1, [1]),
        "sheet": (_job(SHEET_WITH_BUMPER, STILL[:1], HYBRID), 1, [1]),
        "needle": (_job(_scene(NEEDLE), STILL[:1], HYBRID), 1, [1]),
        "no needle": (_job(_scene(), STILL[:1], HYBRID), 1, [1]),
    }
    return dict(zip(orders, lights_of(*orders.values(), near_width_px=WIDTH_PX // 2, coarser=COARSER), strict=True))


HERE = np.array(STILL[0].X_WC)
V, U = np.indices((HEIGHT_PX, WIDTH_PX))
FLOOR_SEEN = floor_points(CAMERA, HERE, np.column_stack([U.ravel(), V.ravel()]).astype(float))
_SPARE_M = 0.012


def _behind(box: Mesh, seen_from: Point3, at: PlanarPose = (0.0, 0.0, 0.0)) -> np.ndarray:
    """(H, W) whether a box along the axes, moved to a place, stands between a point and the floor in each pixel."""
    corners = np.array(box.vertices) + np.array([*at[:2], 0.0])
    towards = np.array(seen_from) - FLOOR_SEEN
    with np.errstate(divide="ignore", invalid="ignore"):
        sides = [
            (corner - FLOOR_SEEN) / towards
            for corner in (corners.min(axis=0) - _SPARE_M, corners.max(axis=0) + _SPARE_M)
        ]
    first, last = np.minimum(*sides).max(axis=1), np.maximum(*sides).min(axis=1)
    return ((first < last) & (last > 0)).reshape(HEIGHT_PX, WIDTH_PX)


EYE = tuple(HERE[:3, 3])
FAR = V < 12
"""Where a pixel sees more than half a metre of floor, or none."""
ROBOT_SHADOW = _behind(ROBOT, BEHIND.center) & ~FAR
BARE = ~(_behind(BOX, EYE) | _behind(BOX, LAMP.center) | _behind(BOX, BEHIND.center) | ROBOT_SHADOW | FAR)


@pytest.mark.parametrize("region", ["bare", "robot's shadow"])
def test_the_floor_is_as_bright_as_in_a_full_image(images, region):
    where, off = (BARE, 0.01) if region == "bare" else (ROBOT_SHADOW, 0.03)
    assert where.sum() > 100
    hybrid, full = (images[f"still {kind}"][0][where].mean(axis=0) for kind in ("hybrid", "full"))
    assert hybrid == pytest.approx(full, rel=off)


def test_the_robot_throws_its_shadow(images):
    """From a lamp that gives about half of the light there."""
    hybrid = images["still hybrid"][0].mean(axis=2)
    assert np.median(hybrid[ROBOT_SHADOW]) < 0.8 * np.median(hybrid[BARE & (V > 36)])


@pytest.mark.parametrize("light", ["as many pixels", "half as many"])
def test_a_glossy_strip_on_a_rough_floor_is_as_bright_as_in_a_full_image(images, shared, light):
    """It lets less through to the colour below it, and mirrors what is behind; both end where it does."""
    hybrid_image = (shared["taped"] if light == "half as many" else images["taped hybrid"])[0]
    hybrid, full = (of[10:18, 40:60].mean(axis=(1, 2)) for of in (hybrid_image, images["taped full"][0]))
    around = np.r_[0:1, 6:8]
    assert np.abs(full[1:6] / full[around].mean() - 1).max() > 0.05
    assert hybrid == pytest.approx(full, rel=0.03)


def test_a_sheet_of_another_material_on_the_floor_is_as_bright_as_in_a_full_image(images):
    (left, bottom), (right, top) = (
        project(CAMERA, HERE, np.array([corner]))[0][0] for corner in ((0.3, 0.2, 0.0), (0.55, 0.12, 0.0))
    )
    sheet = np.s_[int(np.ceil(top)) : int(bottom), int(np.ceil(left)) : int(right)]
    hybrid, full = (images[f"sheet {kind}"][0][sheet] for kind in ("hybrid", "full"))
    assert full.size > 3 * 40
    assert full[..., 0].mean() > 3 * full[..., 1].mean()
    assert hybrid.mean(axis=(0, 1)) == pytest.approx(full.mean(axis=(0, 1)), rel=0.05)


@pytest.mark.parametrize("light", ["as many pixels", "half as many"])
def test_a_part_of_the_robot_in_sight_is_as_bright_as_in_a_full_image(images, shared, light):
    """Its upper face, along the image's foot, and what is around it."""
    (left, top), (right, _), (_, bottom) = project(
        CAMERA, HERE, np.array([(0.23, 0.07, 0.05), (0.23, -0.07, 0.05), (0.17, 0.07, 0.05)])
    )[0]
    face = np.s_[int(np.ceil(top)) + 1 : int(bottom), int(np.ceil(left)) + 1 : int(right)]
    hybrid_image = (shared["sheet"] if light == "half as many" else images["sheet hybrid"])[0]
    full = images["sheet full"][0]
    assert full[face].size > 3 * 40
    assert full[face][..., 1].mean() > 3 * full[face][..., 0].mean()
    assert hybrid_image[face].mean(axis=(0, 1)) == pytest.approx(full[face].mean(axis=(0, 1)), rel=0.05)
    assert hybrid_image[20:].mean(axis=(0, 1)) == pytest.approx(full[20:].mean(axis=(0, 1)), rel=0.03)


@pytest.mark.parametrize("kind", ["at once", "rolling"])
def test_the_image_is_as_bright_as_in_full_while_the_camera_turns(images, kind):
    hybrid, full = (images[f"{kind} {of}"][0][20:].mean(axis=(0, 1)) for of in ("hybrid", "full"))
    assert hybrid == pytest.approx(full, rel=0.02)


def test_upper_rows_traced_separately_are_where_a_rolling_shutter_has_them(images, shared):
    """A box stands in them, before which the camera turns: its edges would be bright or dark were they elsewhere."""
    upper = np.s_[0, :16, 8:56]
    separate, together = (shared["rolling"][upper], images["rolling hybrid"][upper])
    full = images["rolling full"][upper]
    assert np.abs(separate - full).mean() < 1.2 * np.abs(together - full).mean()
    assert separate.mean(axis=(0, 1)) == pytest.approx(full.mean(axis=(0, 1)), rel=0.03)


def test_light_and_line_are_right_behind_a_lens_and_with_odd_numbers_of_pixels(images):
    hybrid, full = (images[f"lens {of}"][0][20:, 10:54] for of in ("hybrid", "full"))
    assert hybrid.mean(axis=(0, 1)) == pytest.approx(full.mean(axis=(0, 1)), rel=0.02)
    (middle, _), (true_middle, _) = (
        _middle_and_variance(_line_columns(images[f"lens {of}"][0])) for of in ("hybrid", "full")
    )
    assert (middle - true_middle).mean() == pytest.approx(0.0, abs=0.05)


def test_a_thing_thinner_than_a_pixel_of_the_light_stands_on_the_floor(shared):
    """Nothing else is so low in the image."""
    (foot,), _ = project(CAMERA, HERE, np.array([[0.36, 0.03, 0.0]]))
    column, row = (round(at) for at in foot.tolist())
    with_, without = (shared[name][0].mean(axis=2) for name in ("needle", "no needle"))
    darker = 1 - (with_ / without)[:, column - 1 : column + 2].sum(axis=1) / 3
    wide_px = 45.0 * 0.003 / np.linalg.norm(np.array([0.36, 0.03, 0.0]) - EYE)
    assert darker[row - 6 : row].min() > 0.7 * wide_px / 3
    assert np.abs(darker[row + 2 : row + 8]).max() < 0.02


@pytest.mark.parametrize("light", ["as many pixels", "half as many"])
def test_a_small_lamp_in_sight_shines_as_in_a_full_image(images, shared, light):
    """No denoiser takes it for noise."""
    (at,), _ = project(CAMERA, HERE, np.array([BULB.center]))
    column, row = (round(float(one)) for one in at)
    around = np.s_[row - 3 : row + 4, column - 3 : column + 4]
    hybrid_image = (shared["taped"] if light == "half as many" else images["taped hybrid"])[0]
    hybrid, full = (of[around].sum(axis=(0, 1)) for of in (hybrid_image, images["taped full"][0]))
    assert full.mean() > 5 * images["still full"][0][around].sum(axis=(0, 1)).mean()
    assert hybrid == pytest.approx(full, rel=0.05)


# Edges


def _line_columns(image: np.ndarray) -> np.ndarray:
    """(rows, columns) how dark it is across the line that leads away, ahead of the robot's shadow."""
    grey = image[20:34, 10:38].mean(axis=2)
    bright = np.median(grey, axis=1, keepdims=True)
    return np.clip(1 - grey / bright, 0, 1) * (grey < 0.85 * bright)


def _middle_and_variance(dark: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of each row [px, px^2]."""
    at, total = np.arange(dark.shape[1]), dark.sum(axis=1)
    middle = dark @ at / total
    return middle, (dark * (at - middle[:, None]) ** 2).sum(axis=1) / total


@pytest.mark.parametrize("kind", ["still", "at once", "rolling"])
def test_the_line_is_where_and_as_wide_as_in_a_full_image(images, kind):
    (middle, variance), (true_middle, true_variance) = (
        _middle_and_variance(_line_columns(images[f"{kind} {of}"][0])) for of in ("hybrid", "full")
    )
    # A row of the fully traced image, blurred over 5 px, is known to about 0.14 with 128 samples.
    assert np.abs(middle - true_middle).max() < 0.35
    assert (middle - true_middle).mean() == pytest.approx(0.0, abs=0.1)
    assert variance.mean() == pytest.approx(true_variance.mean(), rel=0.05)


def test_a_turn_blurs_the_line_and_a_rolling_shutter_shears_it(images):
    """On the axis, a turn of a radian about the vertical takes f cos(pitch) px across."""
    (still, sharp), (_, blurred), (sheared, _) = (
        _middle_and_variance(_line_columns(images[f"{kind} hybrid"][0])) for kind in ("still", "at once", "rolling")
    )
    blur_px = RATE_RAD_S * GLOBAL.exposure_s * CAMERA.fx_px * np.cos(PITCH)
    assert (blurred - sharp)[3:5].mean() == pytest.approx(blur_px**2 / 12, rel=0.25)
    late_px = RATE_RAD_S * ROLLING.read_out_s / HEIGHT_PX * CAMERA.fx_px * np.cos(PITCH)
    assert np.polyfit(np.arange(8), (sheared - still)[:8], 1)[0] == pytest.approx(late_px, rel=0.25)


def test_an_edge_amid_texels_of_the_map_is_where_it_is(images):
    """A strip whose edges lie along the map's columns, in the middle of one: both were off to the same side."""
    near, far = (np.array([x, -0.2, 0.0]) for x in (0.33, 0.37))
    (_, low), (_, high) = project(CAMERA, HERE, np.stack([near, far]))[0]
    rows = np.arange(round(high) - 2, round(low) + 3)
    for of in ("hybrid", "full"):
        grey = images[f"still {of}"][0][rows, 46:60].mean(axis=(1, 2))
        bright = np.interp(rows, rows[[0, -1]], grey[[0, -1]])
        assert np.average(rows, weights=bright - grey) == pytest.approx(0.5 * (low + high), abs=0.1)


# What moves


@pytest.mark.parametrize(("number", "other"), [(1, 2), (2, 1)])
def test_a_moving_obstacle_takes_its_shadow_along(images, number, other):
    hybrid, away = images["still hybrid"][number].mean(axis=2), images["still hybrid"][0].mean(axis=2)
    place = STILL[number].moving[0]
    ours, theirs = (_core(STILL[n].moving[0]) for n in (number, other))
    ours &= ~theirs
    assert ours.sum() >= 4
    full = images["still full"].mean(axis=3)
    dimmed = np.median(full[number][ours] / full[0][ours])
    assert dimmed < 0.85
    assert np.median(hybrid[ours] / away[ours]) == pytest.approx(dimmed, abs=0.06)
    left = theirs & ~_behind(OBSTACLE, EYE, place) & ~_behind(OBSTACLE, LAMP.center, place)
    left &= ~_behind(OBSTACLE, BEHIND.center, place)
    assert left.sum() >= 4
    assert np.median(hybrid[left] / away[left]) == pytest.approx(1.0, abs=0.05)


def _core(place: PlanarPose) -> np.ndarray:
    """(H, W) where a lamp's shadow of the obstacle lies on the floor in sight."""
    seen = _behind(OBSTACLE, LAMP.center, place) & ~_behind(OBSTACLE, EYE, place)
    return seen & ~_behind(BOX, EYE) & ~FAR


# Seen by way of something else


@pytest.mark.parametrize(("kind", "rows"), [("glass", slice(6, 12)), ("mirror", slice(8, 13))])
def test_the_line_is_seen_through_glass_and_in_a_mirror(images, kind, rows):
    """Less sharply than in a full image: its light is denoised."""

    def contrast(of: str) -> float:
        profile = images[f"{kind} {of}"][0][rows, 22:42].mean(axis=(0, 2))
        return 1 - profile[9:11].mean() / np.median(profile)

    assert contrast("full") > 0.7
    assert contrast("hybrid") > 0.5 * contrast("full")


# The same bytes


def test_the_image_does_not_depend_on_threads_or_on_the_images_before_it(images):
    np.testing.assert_array_equal(images["two threads"], images["still hybrid"][[2, 1]])


def test_nor_does_an_image_whose_upper_rows_are_traced_separately(shared):
    np.testing.assert_array_equal(shared["two threads"], shared["still"][[3, 1]])


def test_all_light_is_finite_and_not_negative(images, shared):
    for light in (*images.values(), *shared.values()):
        assert np.isfinite(light).all()
        assert light.min() >= 0


LOOKS = shipped_names("look")


@pytest.fixture(scope="module")
def looks(arena, robot, lights_of) -> dict[str, np.ndarray]:
    """(1, H, W, 3) of a draw of each look at its own exposure time, tiny."""
    orders = []
    for name in LOOKS:
        config, _ = draw_look(load_section("look", name, []), 7, "parts", 1)
        times = np.array([0.0, 0.5, 1.0])
        pose = np.column_stack([0.55 + 0 * times, -0.7 + 0.2 * times, 0.5 * np.pi + 0 * times])
        path = RobotPath(times, pose, np.array([[0.2, 0.0]] * 3))
        frame = FramePose(1, 0.5, 0.55, -0.6, 0.5 * np.pi)
        job = build_job(arena, robot, config, Render(width_px=32, height_px=24), [frame], seed=1, path=path)
        orders.append((replace(job, sampling=replace(job.sampling, hybrid=HybridSamples(1, 1, 4))), 1, [1]))
    return dict(zip(LOOKS, lights_of(*orders, coarser=8), strict=True))


@pytest.mark.long
@pytest.mark.parametrize("look", LOOKS)
def test_every_look_gives_light_that_is_finite_and_not_negative(looks, look):
    (light,) = looks[look]
    assert np.isfinite(light).all()
    assert light.min() >= 0
    assert np.median(light) > 0
