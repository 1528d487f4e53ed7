"""The line in the image lies where the line sensor reads it.

The arena's own edges are projected through the camera model and compared with the decoded JPEG. What is left, 0.2 to
0.3 px, is mostly the shade beside a tape 0.13 mm thick; with surfaces that shine by themselves it is 0.02 to 0.1 px.
"""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from blender_scenes.render.job import FramePose, RenderJob, build_job
from configs.schema.appearance.floors import FloorLook
from configs.schema.appearance.look import CameraLook, LinePaintLook, LookConfig, TapeLook
from configs.schema.robot import LensDistortion
from configs.schema.scenario import Render
from symolo.core.geometry.lens import NO_DISTORTION
from symolo.core.geometry.pinhole import project

POSES = [(0.55, -0.60, 90), (0.545, -0.15, 92), (0.49, 0.68, 133), (-0.55, -0.90, -70), (0.30, -1.04, 15)]
"""x [m], y [m], yaw [deg] on the dataset arena: straights, an obstacle ahead, both arcs, a line end."""

TAPE = LookConfig(
    name="plain",
    floor=FloorLook(material="concrete", dirt=0),
    tape=TapeLook(wear=0),
    camera=CameraLook(contrast=1, vignetting=0, shot_noise=0, read_noise=0),
)
PAINT = TAPE.model_copy(update={"line": "paint", "line_paint": LinePaintLook(wear=0)})
CASES = [("tape", 1), ("tape", 2), ("tape", 4), ("paint", 2)]
"""Kind of line and pose; of paint one with a straight and an arc."""
FURTHER_CASES = [("tape", 0), ("tape", 3)]
LENS = LensDistortion(k1=-0.28, k2=0.09, p1=0.001, p2=-0.002)
_REACH_PX = 6
WIDTH_PX, HEIGHT_PX = 480, 360
LIMIT_PX = 0.3
"""Of the mean distance; as an angle, 0.4 px of an image of 640 px."""


def _linear(image: np.ndarray) -> np.ndarray:
    """Grey value, the sRGB transfer undone (IEC 61966-2-1)."""
    s = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY).astype(np.float64) / 255
    return np.where(s <= 0.04045, s / 12.92, ((s + 0.055) / 1.055) ** 2.4)


def _edge_points(arena, side: int) -> tuple[np.ndarray, np.ndarray]:
    """Points (N, 3) every 5 mm along one edge of the line, and as many 4 mm further out."""
    half, on, out = 0.5 * arena.line.width_m, [], []
    for piece in arena.line.pieces:
        s = np.arange(0.006, piece.length_m - 0.006, 0.005)
        on.append(piece.at(s, side * half))
        out.append(piece.at(s, side * (half + 0.004)))
    flat = [np.concatenate(points) for points in (on, out)]
    return tuple(np.column_stack([p, np.zeros(len(p))]) for p in flat)


def _offset(profile: np.ndarray) -> float:
    """Where a step from dark to bright lies, by the area under it: samples from the profile's middle."""
    dark, bright = profile[:5].mean(), profile[-5:].mean()
    step = (profile - dark) / (bright - dark)
    return 0.5 * (len(profile) - 1) - step.sum() + 0.5


Drive = tuple[int, float, float, float]
"""Image number, x [m], y [m], yaw [deg]."""


def _job(arena, robot, look: LookConfig, drives: list[Drive]) -> RenderJob:
    poses = [FramePose(number, 0.2 * number, x, y, float(np.radians(yaw))) for number, x, y, yaw in drives]
    return build_job(arena, robot, look, Render(width_px=WIDTH_PX, height_px=HEIGHT_PX, samples=1), poses, seed=3)


@pytest.fixture(scope="module")
def frames(tmp_path_factory, arena, robot, images_of) -> dict[str, tuple[RenderJob, Path]]:
    """A job and its images by the kind of line, and of tape behind a lens."""
    moved = {"distortion": LENS, "principal_point_right_mm": 1.5, "principal_point_down_mm": -1.0}
    behind = robot.model_copy(update={"camera": robot.camera.model_copy(update=moved)})
    jobs = {
        look.line: _job(arena, robot, look, [(i + 1, *POSES[i]) for line, i in CASES if line == look.line])
        for look in (TAPE, PAINT)
    }
    jobs["behind a lens"] = _job(arena, behind, TAPE, [(1, *POSES[2])])
    return _rendered(jobs, tmp_path_factory, images_of)


def _rendered(
    jobs: dict[str, RenderJob], tmp_path_factory: pytest.TempPathFactory, images_of: Callable
) -> dict[str, tuple[RenderJob, Path]]:
    folders = {name: tmp_path_factory.mktemp("frames") for name in jobs}
    images_of({folders[name]: job for name, job in jobs.items()})
    return {name: (job, folders[name] / "images") for name, job in jobs.items()}


@pytest.fixture(scope="module")
def further_frames(tmp_path_factory, arena, robot, images_of) -> dict[str, tuple[RenderJob, Path]]:
    drives = [(i + 1, *POSES[i]) for _, i in FURTHER_CASES]
    return _rendered({"tape": _job(arena, robot, TAPE, drives)}, tmp_path_factory, images_of)


def _errors(job: RenderJob, images: Path, arena, index: int) -> np.ndarray:
    """Signed distances [px] of the image's edges from the projected ones, outwards positive."""
    (view,) = (view for view in job.frames if view.number == index + 1)
    image = _linear(cv2.imread(str(images / f"{view.number:06d}.jpg")))
    X_WC = np.array(view.X_WC)
    errors = []
    for side in (1, -1):
        on, out = _edge_points(arena, side)
        (pixel, depth), (further, _) = project(job.camera, X_WC, on), project(job.camera, X_WC, out)
        outward = further - pixel
        length = np.linalg.norm(outward, axis=1)
        seen = (depth > 0) & np.all((pixel > 10) & (pixel < np.array([WIDTH_PX - 11, HEIGHT_PX - 11])), axis=1)
        seen &= length > 3.6  # the tape is then at least 13 px wide and the profile stays on it
        for i in np.flatnonzero(seen):
            if _is_hidden(arena, X_WC[:3, 3], on[i]):
                continue
            at = pixel[i] + outward[i] / length[i] * np.arange(-_REACH_PX, _REACH_PX + 0.01, 0.5)[:, None]
            u, v = at.astype(np.float32).T
            profile = cv2.remap(image, u[:, None], v[:, None], cv2.INTER_LINEAR)[:, 0]
            errors.append(0.5 * _offset(profile))
    return np.array(errors)


def _is_hidden(arena, eye: np.ndarray, point: np.ndarray) -> bool:
    """Whether a box stands near the sight line or casts its contact shadow there."""
    steps = eye[:2] + np.linspace(0.0, 1.0, 40)[:, None] * (point[:2] - eye[:2])
    outlines = [box.footprint().astype(np.float32) for box in arena.boxes]
    away = [cv2.pointPolygonTest(o, (float(x), float(y)), measureDist=True) for o in outlines for x, y in steps]
    return max(away) > -0.02


@pytest.mark.parametrize(("line", "index"), CASES)
def test_the_line_in_the_image_lies_where_the_sensor_reads_it(frames, arena, line, index):
    errors = _errors(*frames[line], arena, index)
    assert len(errors) >= 40
    assert np.abs(errors).mean() < LIMIT_PX


@pytest.mark.long
@pytest.mark.parametrize(("line", "index"), FURTHER_CASES)
def test_the_line_lies_there_on_another_straight_and_the_other_arc(further_frames, arena, line, index):
    errors = _errors(*further_frames[line], arena, index)
    assert len(errors) >= 40
    assert np.abs(errors).mean() < LIMIT_PX


def test_the_line_lies_there_behind_a_lens_too(frames, arena):
    """Its axis off the middle, and an arc, so that the line is bent and nowhere only displaced along itself."""
    job, images = frames["behind a lens"]
    errors = _errors(job, images, arena, 0)
    assert len(errors) >= 40
    assert np.abs(errors).mean() < LIMIT_PX
    on, _ = _edge_points(arena, 1)
    X_WC, pinhole = np.array(job.frames[0].X_WC), replace(job.camera, distortion=NO_DISTORTION)
    (there, depth), (without, _) = (project(camera, X_WC, on) for camera in (job.camera, pinhole))
    seen = (depth > 0) & np.all((there > 10) & (there < np.array([WIDTH_PX - 11, HEIGHT_PX - 11])), axis=1)
    assert np.linalg.norm(there - without, axis=1)[seen].mean() > 5  # an image without the lens would not pass
