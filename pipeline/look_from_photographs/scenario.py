"""The scenario beside a fitted look: the camera where the photographs were taken from, and the line in its width."""

import math

import numpy as np

from configs.draw import draw_run
from configs.loader import load_scenario
from configs.schema.robot import RobotConfig
from diagnosis.photographs.fitted_look import FittedLook
from diagnosis.photographs.measures import median_of
from pipeline.look_from_photographs.views import SCENARIO, ViewGeometry
from symolo.core.errors import InputError
from symolo.core.progress import plural

_MAX_HEIGHT_M = 2.0
_NO_CONTRAST = 1.0
"""Contrast of a camera whose tone curve is that of sRGB."""
_AHEAD_M = 0.13
"""Place of the camera ahead of the axle: before the body of the robot, and near enough to keep the line in sight."""
_FURTHER_M = 0.25
"""Place whose shadow is stated too."""
_CURVE_M = 0.3
"""Radius of a curve, of which is stated how far the line is then from the middle of the image."""
_SENSOR_TOP_M = 0.006
"""Half the height of the board of a range sensor."""


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


def _distance_range_mm(look: FittedLook, geometry: ViewGeometry) -> tuple[int, int]:
    """Return the smallest and the largest distance of the camera from the floor, in whole millimetres outwards.

    Photographs do not reveal the contrast of the camera, on which the edges of the line depend. The range is that of
    all photographs, each with the contrast of the fit and with that of sRGB.
    """
    distances_m = [
        geometry.distance_m(photograph.with_light_edges(contrast).place)
        for photograph in look.photographs
        for contrast in (look.camera.look.contrast, _NO_CONTRAST)
    ]
    return math.floor(1000 * min(distances_m)), math.ceil(1000 * max(distances_m))


def view_begins_m(height_m: float, geometry: ViewGeometry, size_px: tuple[int, int]) -> float:
    """Return how far ahead of the camera the lower edge of the image shows the floor; negative behind the camera."""
    across, (width_px, rows_px) = np.tan(np.radians(0.5 * geometry.field_of_view_deg)), size_px
    down = np.radians(geometry.pitch_down_deg) + np.arctan(across * rows_px / width_px)
    return float(height_m / np.tan(down))


def shadow_below_deg(robot: RobotConfig, begins_m: float) -> float:
    """Return the elevation of a light behind the robot below which the shadow of its body reaches a place ahead.

    Args:
        robot: The robot; only its plate and its range sensors count, which are foremost and highest.
        begins_m: The place ahead of the axle [m].
    """
    mounts = (robot.tof.mounts.front, robot.tof.mounts.left, robot.tof.mounts.right)
    parts = [(0.5 * robot.chassis.length_m, robot.chassis.base_height_m)]
    parts += [(mount.x_m, mount.z_m + _SENSOR_TOP_M) for mount in mounts]
    return max(float(np.degrees(np.arctan2(top_m, max(0.0, begins_m - front_m)))) for front_m, top_m in parts)


def shadow_warning(look: FittedLook, geometry: ViewGeometry) -> str:
    """Return which light casts the shadow of the robot into its image, with the camera here and further ahead."""
    robot, height_m = _robot(), camera_height_m(look, geometry)
    begins_m = view_begins_m(height_m, geometry, look.size_px)
    here, further = (shadow_below_deg(robot, x_m + begins_m) for x_m in (_AHEAD_M, _FURTHER_M))
    distance_m = height_m / np.sin(np.radians(geometry.pitch_down_deg))
    off_mm, off_further_mm = _off_mm(_AHEAD_M), _off_mm(_FURTHER_M)
    half_mm = 1000.0 * distance_m * np.tan(np.radians(0.5 * geometry.field_of_view_deg))
    return (
        f"images show the shadow of the robot where a lamp or the sun stands behind it, lower than {here:.0f} degrees; "
        f"with robot.camera.x_m={_FURTHER_M:g} in place of {_AHEAD_M:g}, lower than {further:.0f}. In a curve of "
        f"{_CURVE_M:g} m radius, the line is then {off_further_mm:.0f} mm from the middle of the image in place of "
        f"{off_mm:.0f} mm, and the image shows {half_mm:.0f} mm to each side"
    )


def _off_mm(ahead_m: float) -> float:
    return 1000.0 * ahead_m**2 / (2.0 * _CURVE_M)


def _robot() -> RobotConfig:
    loaded = load_scenario(SCENARIO)
    return draw_run(loaded, loaded.routes[0].name, 1).robot


def scenario_text(look: FittedLook, look_file: str, geometry: ViewGeometry) -> str:
    """Return the file of a scenario whose images show the line as the photographs do."""
    base_height_m = _robot().chassis.base_height_m
    height_m = camera_height_m(look, geometry)
    line_px = median_of(look.photographs, lambda p: p.place.width_px)
    width_px, height_px = look.size_px
    spread = " to ".join(f"{limit_mm}" for limit_mm in _distance_range_mm(look, geometry)) + " mm"
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
    x_m: {_AHEAD_M}  # assumed: ahead of the body, whose shadow the image shows if the light comes from behind
    y_m: 0  # assumed
    height_above_base_m: {height_m - base_height_m:.4f}  # {1000 * height_m:.0f} mm above the floor: distance {spread}
    pitch_down_deg: {geometry.pitch_down_deg:.6g}  # --pitch-down-deg
    field_of_view_deg: {geometry.field_of_view_deg:.6g}  # --field-of-view-deg
render: {{width_px: {width_px}, height_px: {height_px}}}  # size of the photographs
"""
