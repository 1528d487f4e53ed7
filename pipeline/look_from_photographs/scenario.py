"""The scenario beside a fitted look: the camera where the photographs were taken from, and the line in its width."""

import numpy as np

from configs.draw import draw_run
from configs.loader import load_scenario
from diagnosis.photographs.fitted_look import FittedLook
from diagnosis.photographs.measures import median_of
from pipeline.look_from_photographs.views import SCENARIO, ViewGeometry
from symolo.core.errors import InputError
from symolo.core.progress import plural

_MAX_HEIGHT_M = 2.0
_AHEAD_M = 0.13
"""Place of the camera ahead of the axle: before the body of the robot, whose shadow it then does not see."""


def camera_height_m(look: FittedLook, geometry: ViewGeometry) -> float:
    """Return the height of the camera above the floor.

    Raises:
        InputError: It is higher than the camera of a robot can be.
    """
    distance_m = median_of(look.photographs, lambda p: geometry.distance_m(p.place))
    height_m = float(distance_m * np.sin(np.radians(geometry.pitch_down_deg)))
    if height_m > _MAX_HEIGHT_M:
        problem = f"the camera would be {height_m:.1f} m above the floor"
        cure = "correct the width of the line or the field of view"
        raise InputError(problem, where="--line-width-mm", allowed=f"at most {_MAX_HEIGHT_M:.0f} m", cure=cure)
    return height_m


def scenario_text(look: FittedLook, look_file: str, geometry: ViewGeometry) -> str:
    """Return the file of a scenario whose images show the line as the photographs do."""
    loaded = load_scenario(SCENARIO)
    base_height_m = draw_run(loaded, loaded.routes[0].name, 1).robot.chassis.base_height_m
    distances_m = [geometry.distance_m(photograph.place) for photograph in look.photographs]
    height_m = camera_height_m(look, geometry)
    line_px = median_of(look.photographs, lambda p: p.place.width_px)
    width_px, height_px = look.size_px
    spread = f"{1000 * min(distances_m):.0f} to {1000 * max(distances_m):.0f} mm"
    return f"""\
# View of {plural(len(look.photographs), "photograph")}: the line is {line_px:.0f} px wide where it crosses the image.
# Routes and robot are those of `{SCENARIO}`, except the camera. A comment names what set each value.
extends: {SCENARIO}
name: {look.name}
description: Line and camera as in {plural(len(look.photographs), "photograph")}
look: {look_file}
arena:
  line: {{width_m: {geometry.line_width_m:.6g}}}  # --line-width-mm
robot:
  camera:
    x_m: {_AHEAD_M}  # assumed: ahead of the body, out of its shadow
    y_m: 0  # assumed
    height_above_base_m: {height_m - base_height_m:.4f}  # {1000 * height_m:.0f} mm above the floor: distance {spread}
    pitch_down_deg: {geometry.pitch_down_deg:.6g}  # --pitch-down-deg
    field_of_view_deg: {geometry.field_of_view_deg:.6g}  # --field-of-view-deg
render: {{width_px: {width_px}, height_px: {height_px}}}  # size of the photographs
"""
