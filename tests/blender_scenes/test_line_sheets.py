"""Sheets of paper beneath the line: where they lie, and that they are floor for everything but the eye."""

import numpy as np
import pytest
from shapely import Polygon, union_all

from blender_scenes.annotations.instances import instances
from blender_scenes.preview.renderer import FlatRenderer
from blender_scenes.render.job import FramePose, build_job
from blender_scenes.scene.run_scene import describe
from configs.schema.appearance.look import CameraLook, LineSheetsLook, LookConfig, TapeLook
from configs.schema.appearance.paint import Paint
from configs.schema.scenario import Render
from symolo.core.geometry.pinhole import project

PLAIN = LookConfig(name="plain", camera=CameraLook(shot_noise=0, read_noise=0))
SHEETS = LineSheetsLook(width_m=0.1, length_m=0.3, shift_m=0.01)


def laid(look=SHEETS):
    return PLAIN.model_copy(update={"line_sheets": look})


@pytest.fixture(scope="module")
def sheets(arena, robot):
    """Corners (N, 4, 3) of the sheets along the line of the shipped arena."""
    floor = describe(arena, robot, laid(), seed=1).meshes[0]
    corners = np.array(floor.vertices)[np.array(floor.faces)]
    assert set(floor.face_surface[1:]) == {"line_sheets"}
    assert floor.face_surface[0] == "floor"
    return corners[1:]


def test_the_sheets_cover_the_line_and_a_border_beside_it(arena, sheets):
    covered = union_all([Polygon(sheet[:, :2]) for sheet in sheets]).buffer(0.003)  # joints of sheets in a bend
    for left, right in arena.line.edges():
        assert covered.contains(Polygon(np.concatenate([left, right[::-1]])).buffer(0.005))


def test_each_sheet_has_the_set_size_and_lies_on_the_line(arena, sheets):
    sides = np.linalg.norm(sheets[:, 1] - sheets[:, 0], axis=1), np.linalg.norm(sheets[:, 3] - sheets[:, 0], axis=1)
    assert sides[0] == pytest.approx(0.3)
    assert sides[1] == pytest.approx(0.1)
    for middle in sheets.mean(axis=1)[:, :2]:
        assert min(np.abs(piece.local(middle[None])[1][0]) for piece in arena.line.pieces) <= 0.01 + 1e-9


def test_all_sheets_are_between_the_floor_and_the_thinnest_line(arena, robot, sheets):
    thin = laid().model_copy(update={"tape": TapeLook(thickness_m=0.00001, lift_m=0)})
    line = np.array(describe(arena, robot, thin, seed=1).meshes[1].vertices)
    assert sheets[..., 2].min() > 0
    assert sheets[..., 2].max() < line[:, 2].min()


def test_labels_and_everything_else_are_those_of_a_floor_without_sheets(arena, robot):
    with_them, without = describe(arena, robot, laid(), seed=1), describe(arena, robot, PLAIN, seed=1)
    assert instances(with_them, arena) == instances(without, arena)
    assert with_them.meshes[1:] == without.meshes[1:]
    unused = laid(LineSheetsLook(width_m=0, length_m=0.5))
    assert describe(arena, robot, unused, seed=1) == without


def test_an_image_shows_the_sheets_beside_the_line_and_not_farther_away(arena, robot):
    look = laid(SHEETS.model_copy(update={"paint": Paint(reflectance=0.9, hue_deg=0, saturation=0)}))
    pose, small = FramePose(number=1, t_s=0.0, x_m=0.55, y_m=-0.6, yaw_rad=np.pi / 2), Render(width_px=64, height_px=48)
    jobs = [build_job(arena, robot, one, small, [pose], seed=5) for one in (PLAIN, look)]
    plain, papered = (FlatRenderer(job).light(job.frames[0], job.camera).mean(axis=-1) for job in jobs)
    points = {name: np.array([[x, -0.40, 0.0]]) for name, x in (("line", 0.55), ("sheet", 0.525), ("floor", 0.47))}
    change = {}
    for name, point in points.items():
        column, row = np.rint(project(jobs[0].camera, np.array(jobs[0].frames[0].X_WC), point)[0][0]).astype(int)
        change[name] = papered[row, column] / plain[row, column]
    assert change["sheet"] > 1.3
    assert change["line"] == pytest.approx(1, abs=0.1)
    assert change["floor"] == pytest.approx(1, abs=0.1)


def test_another_seed_lays_them_otherwise(arena, robot, sheets):
    other = describe(arena, robot, laid(), seed=2).meshes[0]
    assert not np.allclose(np.array(other.vertices)[4:], sheets.reshape(-1, 3))
    assert other == describe(arena, robot, laid(), seed=2).meshes[0]
