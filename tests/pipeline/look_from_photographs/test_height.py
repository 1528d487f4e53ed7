"""The height of the camera over a line of known width: a pinhole of focal length f shows a width w at h as f w / h."""

import math
import re

import cv2
import pytest

from configs.draw import draw_run
from configs.loader import load_scenario
from pipeline.look_from_photographs.fit import fit_look
from pipeline.look_from_photographs.photographs import read_photographs
from pipeline.look_from_photographs.scenario import camera_height_m, scenario_text
from pipeline.look_from_photographs.views import ViewGeometry
from tests.known_photographs import photograph

HEIGHT_M, LINE_M, VIEW_DEG, SLANT = 0.090, 0.019, 60.0, 0.2
FOCAL_PX = 80.0 / math.tan(math.radians(0.5 * VIEW_DEG))
"""Of images that are 160 px wide."""
WIDTH_PX = FOCAL_PX * LINE_M / HEIGHT_M / math.cos(math.atan(SLANT))
"""Width along a row of a slanted line."""
DARK, LIGHT = (0.05, 0.40), (0.50, 0.08)
"""Light of line and floor."""
GEOMETRY = ViewGeometry(LINE_M, 90.0, VIEW_DEG)


def fitted(folder, blur_px, levels, contrast):
    """Return the look of four photographs, with a camera of this contrast in the base look."""
    (folder / "base.yaml").write_text(f"{{extends: classroom, name: base, camera: {{contrast: {contrast}}}}}")
    files = []
    for k in range(4):
        line, floor = levels
        image = photograph(k, blur_px, slant=SLANT, line=line, floor=floor, width_px=WIDTH_PX, read=0.002)
        path = folder / f"{k}.png"
        cv2.imwrite(str(path), image)
        files.append((path, path.read_bytes()))
    read = read_photographs(files, None)
    base = str(folder / "base.yaml")
    return fit_look(read, folder / "look", base, floor="concrete", floor_reflectance=None, geometry=GEOMETRY)


CASES = [
    (0.5, DARK),
    (2.5, LIGHT),
    *(pytest.param(*case, marks=pytest.mark.long) for case in ((0.5, LIGHT), (1.3, DARK), (1.3, LIGHT), (2.5, DARK))),
]
"""Blur [px] and levels of the photographs."""


@pytest.mark.parametrize(("blur_px", "levels"), CASES)
def test_the_height_of_the_camera_does_not_depend_on_the_blur(blur_px, levels, tmp_path):
    look = fitted(tmp_path, blur_px, levels, 1.0)
    assert camera_height_m(look, GEOMETRY) == pytest.approx(HEIGHT_M, rel=0.01)


@pytest.mark.parametrize(("blur_px", "levels"), CASES)
def test_the_stated_range_contains_the_height_also_with_the_contrast_of_another_camera(blur_px, levels, tmp_path):
    """Photographs do not reveal the contrast; that of `raspberry_pi` is 1.33, and that of these photographs 1."""
    look = fitted(tmp_path, blur_px, levels, 1.33)
    (stated,) = re.findall(r"distance (\d+) to (\d+) mm", scenario_text(look, "look.yaml", GEOMETRY))
    low_mm, high_mm = map(float, stated)
    assert low_mm <= 1000 * HEIGHT_M <= high_mm
    assert high_mm - low_mm <= 0.06 * 1000 * HEIGHT_M
    assert low_mm <= 1000 * camera_height_m(look, GEOMETRY) <= high_mm


def test_the_scenario_has_the_line_in_the_width_of_the_photographs(tmp_path):
    look = fitted(tmp_path, 1.3, DARK, 1.0)
    (tmp_path / "scenario.yaml").write_text(
        scenario_text(look, "look.yaml", GEOMETRY).replace("look: look.yaml", "look: classroom")
    )
    loaded = load_scenario(str(tmp_path / "scenario.yaml"))
    robot = draw_run(loaded, loaded.routes[0].name, 1).robot
    height_m = robot.chassis.base_height_m + robot.camera.height_above_base_m
    assert FOCAL_PX * LINE_M / height_m == pytest.approx(WIDTH_PX * math.cos(math.atan(SLANT)), rel=0.01)
