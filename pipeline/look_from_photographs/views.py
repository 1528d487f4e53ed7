"""Views of a line as in photographs: the same width, place and slant in the image, on other places of the floor."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from blender_scenes.render.job import FramePose
from configs.draw import draw_run
from configs.loader import load_scenario
from configs.schema.arena import ArenaConfig
from configs.schema.robot import LensDistortion, RobotConfig
from diagnosis.photographs.line_place import LinePlace
from pipeline.preview.views import PreviewImage
from pipeline.stages.render import Appearance
from symolo.core.random_streams import stream

SCENARIO = "smoke"
"""Scenario with the robot, whose arena is replaced by a straight line."""
_REACH = 20.0
"""Length of the line and of the sheets around it, in distances of the camera from the floor."""


@dataclass(frozen=True)
class ViewGeometry:
    """What decides how large the line and the texture of the floor are in an image."""

    line_width_m: float = 0.015
    pitch_down_deg: float = 90.0
    """Angle of the optical axis below the horizon; 90 looks straight down."""
    field_of_view_deg: float = 60.0
    """Angle from the left border of the photographs to the right one."""

    def focal_px(self, place: LinePlace) -> float:
        """Return the focal length in pixels of a photograph."""
        return 0.5 * place.upright_size_px[0] / np.tan(np.radians(0.5 * self.field_of_view_deg))

    def m_per_px(self, place: LinePlace) -> float:
        """Return the size of a pixel in the middle of a photograph, square to its axis, from the width of the line."""
        slope = float(np.polyfit(place.rows_px, place.x_px, 1)[0])
        # A line from left to right is foreshortened.
        foreshortened = np.sin(np.radians(self.pitch_down_deg)) if place.is_turned else 1.0
        return self.line_width_m * foreshortened / (place.width_px * np.cos(np.arctan(slope)))

    def distance_m(self, place: LinePlace) -> float:
        """Return the distance of the camera from the floor along its optical axis."""
        return self.m_per_px(place) * self.focal_px(place)


def look_views(
    look: str, places: Sequence[LinePlace], geometry: ViewGeometry, count: int, seed: int
) -> Iterator[PreviewImage]:
    """Yield one view for each of `count` runs with a look; views repeat the lines of photographs in turn.

    The same arguments give the same views. A view of another look with the same number has the same place and seed.

    Args:
        look: Name of a shipped look, or a path.
        places: Lines of photographs of one size.
        geometry: Camera and line.
        count: Number of views.
        seed: Seed of the places and of what the look draws.
    """
    width_px, height_px = places[0].upright_size_px
    size = (f"render.width_px={width_px}", f"render.height_px={height_px}", "render.method=full")
    loaded = load_scenario(SCENARIO, (f"look={json.dumps(look)}", f"seed={seed}", *size))
    route = loaded.routes[0].name
    for k in range(count):
        spec = draw_run(loaded, route, k + 1)
        place = places[k % len(places)]
        robot, frame, reach_m = _camera(spec.robot, place, geometry, seed, k)
        shown = replace(Appearance.from_spec(spec), arena=_straight_line(geometry.line_width_m, reach_m), robot=robot)
        yield PreviewImage(k + 1, f"view {k + 1}", (), frame, shown, loaded.assets)


def _straight_line(width_m: float, reach_m: float) -> ArenaConfig:
    piece = {"kind": "straight", "start": (-reach_m, 0.0), "end": (reach_m, 0.0)}
    return ArenaConfig.model_validate({"name": "line", "line": {"width_m": width_m, "pieces": [piece]}})


def _camera(
    robot: RobotConfig, place: LinePlace, geometry: ViewGeometry, seed: int, number: int
) -> tuple[RobotConfig, FramePose, float]:
    """Return the robot with its camera, its pose, and half the length of the line [m].

    The distance of the camera follows from the width of the line in the image. In a turned image the line runs from
    left to right, so that the robot is turned by 90 degrees.
    """
    height_px, width_px = place.shape
    slope = float(np.polyfit(place.rows_px, place.x_px, 1)[0])
    pitch, distance_m = np.radians(geometry.pitch_down_deg), geometry.distance_m(place)
    height_m, ahead_m = distance_m * np.sin(pitch), distance_m * np.cos(pitch)
    right_m = (np.interp(0.5 * height_px, place.rows_px, place.x_px) - 0.5 * (width_px - 1)) * geometry.m_per_px(place)
    yaw = -np.arctan(slope) + (np.pi / 2 if place.is_turned else 0.0)
    along_m = stream(seed, "place on the line", number).uniform(-0.5, 0.5) * distance_m
    # The camera is on a boom, so that the robot casts no shadow into its image.
    camera = robot.camera.model_copy(update={"x_m": 0.2})
    # The point of the floor in the middle of the image; the line lies `right_m` beside it, square to the line.
    x_m, y_m = along_m, right_m * np.cos(np.arctan(slope))
    ahead_of_robot_m = camera.x_m + ahead_m
    x_m, y_m = x_m - ahead_of_robot_m * np.cos(yaw), y_m - ahead_of_robot_m * np.sin(yaw)
    frame = FramePose(number + 1, 0.0, float(x_m), float(y_m), float(yaw))
    mounted = {
        "y_m": 0.0,
        "height_above_base_m": float(height_m - robot.chassis.base_height_m),
        "pitch_down_deg": geometry.pitch_down_deg,
        "yaw_left_deg": 0.0,
        "roll_deg": 0.0,
        "focal_length_mm": float(camera.sensor_width_mm / (2 * np.tan(np.radians(0.5 * geometry.field_of_view_deg)))),
        "distortion": LensDistortion(),
        "read_out_s": 0.0,
    }
    return robot.model_copy(update={"camera": camera.model_copy(update=mounted)}), frame, _REACH * distance_m
