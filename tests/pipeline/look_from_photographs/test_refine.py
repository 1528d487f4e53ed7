"""The correction of a look by rendered images."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from configs.schema.appearance.camera_look import CameraLook
from diagnosis.photographs.camera_fit import fit_camera
from diagnosis.photographs.fitted_look import FittedLook
from diagnosis.photographs.line_place import find_lines
from diagnosis.photographs.measures import PhotographMeasures
from pipeline.cli import main
from pipeline.look_from_photographs import refine
from pipeline.look_from_photographs.views import ViewGeometry, look_views
from symolo.core.geometry.pinhole import intrinsics, pose_X_RC, project
from symolo.core.geometry.poses import pose_X_WR
from symolo.core.progress import LineReport
from tests.known_photographs import photograph

GEOMETRY = ViewGeometry(line_width_m=0.019, pitch_down_deg=90, field_of_view_deg=60)
BLUR_PX, LOSS = 1.2, 0.3


def measured(*images):
    return tuple(PhotographMeasures.from_place("known", place) for place in find_lines(images))


@pytest.fixture(scope="module")
def photographs():
    return measured(*(photograph(k, blur_px=BLUR_PX, loss=LOSS, shot=0.01, read=0.004) for k in range(3)))


@pytest.mark.parametrize("pitch_down_deg", [90, 60])
@pytest.mark.parametrize("is_turned", [False, True])
def test_a_view_shows_the_line_where_the_photograph_has_it(pitch_down_deg, is_turned):
    """The edges of a line of 19 mm along x are projected through the pinhole of the view."""
    image = photograph(1, slant=0.2)
    (place,) = find_lines([np.ascontiguousarray(image.transpose(1, 0, 2)) if is_turned else image])
    (view,) = look_views("lab", [place], replace(GEOMETRY, pitch_down_deg=pitch_down_deg), 1, seed=4)
    robot, frame = view.appearance.robot, view.frame
    camera = intrinsics(robot.camera, *place.upright_size_px)
    X_WC = pose_X_WR(frame.x_m, frame.y_m, frame.yaw_rad) @ pose_X_RC(robot.camera, robot.chassis.base_height_m)
    row = 0.5 * (place.shape[0] - 1)
    edges = []
    for y_m in (-0.0095, 0.0095):
        x_m = np.linspace(-0.06, 0.06, 2001)
        pixels, _ = project(camera, X_WC, np.column_stack([x_m, np.full_like(x_m, y_m), np.zeros_like(x_m)]))
        along, across = pixels.T if is_turned else pixels.T[::-1]
        order = np.argsort(along)
        edges.append(float(np.interp(row, along[order], across[order])))
    assert 0.5 * sum(edges) == pytest.approx(float(np.interp(row, place.rows_px, place.x_px)), abs=2.5)
    assert abs(edges[1] - edges[0]) == pytest.approx(place.width_px, rel=0.1)


def test_settings_approach_those_with_which_renderings_are_like_the_photographs(photographs, monkeypatch):
    """The renderer of this test adds a blur of 0.6 px and a loss of 0.1 to those of the camera."""

    def fake(_engine, views, _workers, _report):
        look = views[0].appearance.look.camera
        blur_px, loss = np.hypot(look.lens_blur_px, 0.6), look.vignetting + 0.1
        settings = {"blur_px": blur_px, "loss": loss, "shot": look.shot_noise, "read": look.read_noise}
        return {view.number: photograph(view.number, **settings) for view in views}, []

    monkeypatch.setattr(refine, "render_views", fake)
    monkeypatch.setattr(refine, "MIN_IMAGES", 2)
    camera = fit_camera(photographs, CameraLook(contrast=1.0, saturation=1.0))
    look = FittedLook("known", "lab", photographs, camera, "concrete", 0.45, reflectance_is_assumed=True)
    settings = refine.RenderSettings(GEOMETRY, workers=1)
    refined = refine.refined(look, settings, LineReport())
    assert refined.camera.look.lens_blur_px == pytest.approx(np.sqrt(BLUR_PX**2 - 0.6**2), rel=0.1)
    assert refined.camera.look.vignetting == pytest.approx(LOSS - 0.1, abs=0.03)
    # The renderings have no texture, so that the look has as much as it can.
    assert "stains: " in refined.text(Path("/"))
    assert len(refined.rendered) == 3


@pytest.mark.long
def test_rendered_images_come_near_the_photographs(tmp_path):
    import cv2  # noqa: PLC0415

    for k in range(3):
        cv2.imwrite(str(tmp_path / f"{k}.png"), photograph(k, blur_px=BLUR_PX, loss=LOSS, shot=0.01, read=0.004))
    files = sorted(map(str, tmp_path.glob("*.png")))
    assert main(["look", "from", *files, "--base", "classroom", "--out", str(tmp_path / "look")]) == 0
    page = (tmp_path / "look/report.html").read_text()
    assert "rendered images, median" in page
