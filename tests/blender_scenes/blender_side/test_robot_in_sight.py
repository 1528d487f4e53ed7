"""The robot's own body in its camera's sight: annotated once, and held against rays that meet boxes in closed form."""

import cv2
import numpy as np
import pytest

from blender_scenes.annotations.job import build_annotation_job
from blender_scenes.annotations.record import FrameRecord
from blender_scenes.preview.renderer import FlatRenderer
from blender_scenes.render.job import FramePose, RenderJob, build_job
from blender_scenes.render.renderer import render_job
from configs.draw import draw_robot
from configs.loader import load_section
from configs.schema.appearance.look import LookConfig
from configs.schema.arena import ArenaConfig
from configs.schema.scenario import Render
from symolo.arena.geometry import Arena
from symolo.core.geometry.pinhole import matrix_K
from symolo.dataset.annotations import CATEGORIES

ARENA = {"name": "line", "line": {"pieces": [{"kind": "straight", "start": [0.0, 0.0], "end": [1.2, 0.0]}]}}
POSES = [FramePose(1, 0.0, 0.1, 0.0, 0.0), FramePose(2, 0.2, 0.13, 0.01, 0.1)]
KINDS = ("semantic", "depth", "flow", "key_points")
CAMERA_BODY = {"robot_camera"}


@pytest.fixture(scope="module")
def job_of():
    """The shipped robot's, its camera turned down to 50 degrees and told whether it sees the robot."""
    robot = draw_robot(load_section("robot", "nominal"), 1, "CW", 1)[0]

    def made(*, sees_robot: bool) -> RenderJob:
        camera = robot.camera.model_copy(update={"pitch_down_deg": 50.0, "sees_robot": sees_robot})
        arena, render = Arena.from_config(ArenaConfig.model_validate(ARENA)), Render(width_px=96, height_px=72)
        return build_job(arena, robot.model_copy(update={"camera": camera}), LookConfig(name="plain"), render, POSES, 1)

    return made


@pytest.fixture(scope="module")
def annotated(job_of, tmp_path_factory):
    job = build_annotation_job(job_of(sees_robot=True), Arena.from_config(ArenaConfig.model_validate(ARENA)), KINDS)
    folder = tmp_path_factory.mktemp("annotated")
    (folder / "job.json").write_text(job.to_json())
    assert render_job(folder / "job.json", folder / "files", work="annotations").made == len(POSES)
    return job, folder / "files"


def _image(annotated, kind):
    return cv2.imread(str(annotated[1] / kind / "000001.png"), cv2.IMREAD_UNCHANGED)


def _depth_of_body(job, pixels):
    """(N,) along the axis to where each pixel's ray enters a box of the body, inf where it meets none; by slabs.

    Wheels are round; they lie outside of the image, which the comparison shows.
    """
    X_RC = np.linalg.inv(_X_WR(job.frames[0].robot_pose)) @ np.array(job.frames[0].X_WC)
    rays = np.column_stack([pixels, np.ones(len(pixels))]) @ np.linalg.inv(matrix_K(job.camera)).T @ X_RC[:3, :3].T
    nearest = np.full(len(pixels), np.inf)
    for mesh in job.scene.robot_in_sight:
        corners = np.array(mesh.vertices)
        with np.errstate(divide="ignore"):
            ends = [(corner - X_RC[:3, 3]) / rays for corner in (corners.min(axis=0), corners.max(axis=0))]
        enters, leaves = np.minimum(*ends).max(axis=1), np.maximum(*ends).min(axis=1)
        nearest = np.where((enters < leaves) & (enters > 0), np.minimum(nearest, enters), nearest)
    return nearest


def _X_WR(pose):
    x, y, yaw = pose
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s, 0, x], [s, c, 0, y], [0, 0, 1, 0], [0, 0, 0, 1.0]])


def _clear(job):
    """Depth (H, W) of the body in the pixels' middles, and where it is one thing in all of a pixel's inner part."""
    v, u = np.indices((job.camera.height_px, job.camera.width_px))
    at = np.stack([u.ravel(), v.ravel()], axis=1).astype(float)
    depth = _depth_of_body(job, at)
    around = [_depth_of_body(job, at + 0.2 * np.array([a, b])) for a in (-1, 1) for b in (-1, 1)]
    clear = np.all([np.isfinite(one) == np.isfinite(depth) for one in around], axis=0)
    return depth.reshape(v.shape), clear.reshape(v.shape)


def test_the_flat_preview_shows_it_too(job_of):
    seen, hidden = (job_of(sees_robot=sees) for sees in (True, False))
    lights = [FlatRenderer(job).light(job.frames[0], job.camera) for job in (seen, hidden)]
    body, clear = _clear(seen)
    differs = (lights[0] != lights[1]).any(axis=2)
    assert np.array_equal(differs[clear], np.isfinite(body)[clear])


def test_a_job_knows_nothing_of_a_robot_that_is_not_to_be_seen(job_of):
    scene = job_of(sees_robot=False).scene
    assert scene.robot_in_sight == ()
    assert "robot_in_sight" not in job_of(sees_robot=False).to_json()


def test_in_sight_is_all_but_the_camera_itself(job_of):
    hidden, seen = (job_of(sees_robot=sees).scene for sees in (False, True))
    assert {mesh.name for mesh in seen.robot} == CAMERA_BODY
    assert {mesh.name for mesh in seen.robot_in_sight} == {mesh.name for mesh in hidden.robot} - CAMERA_BODY
    job = job_of(sees_robot=True)
    assert RenderJob.from_json(job.to_json()) == job


def test_the_mask_of_the_robot_is_where_rays_meet_its_boxes(annotated):
    body, clear = _clear(annotated[0])
    mask = _image(annotated, "semantic") == CATEGORIES.index("robot")
    assert 100 < mask.sum() < 0.5 * mask.size
    assert clear.mean() > 0.9
    assert np.array_equal(mask[clear], np.isfinite(body)[clear])


def test_its_depth_is_that_of_the_boxes_and_it_stands_still_in_the_image(annotated):
    body, clear = _clear(annotated[0])
    inside = clear & np.isfinite(body)
    assert _image(annotated, "depth")[inside] / 10_000 == pytest.approx(body[inside], abs=1e-4)
    flow = _image(annotated, "flow")[..., ::-1][inside].astype(float)
    assert np.all(flow[:, 2] == 1)
    assert np.abs(flow[:, :2] - 32768).max() == 0


def test_it_hides_the_points_of_the_line_behind_it(annotated):
    job, folder = annotated
    sightings = FrameRecord.from_json((folder / "records/000001.json").read_bytes()).key_points
    body = _depth_of_body(job, np.array([one.pixel for one in sightings]))
    hidden = body < np.array([one.p_C[2] for one in sightings])
    assert 0 < hidden.sum() < len(hidden)
    assert [not one.visible for one in sightings] == hidden.tolist()
