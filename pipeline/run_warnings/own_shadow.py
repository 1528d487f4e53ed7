"""Cameras whose images show the shadow of the robot on the floor, but not the robot that casts it."""

from collections.abc import Iterator

from configs.schema.scenario import RunSpec
from pipeline.run_warnings.suspicion import Suspicion
from pipeline.stages.cameras import cameras_of

MAX_DOWN_DEG = 75.0
"""Angle below the horizon from which on a camera of a usual robot sees the floor beneath its own sensors."""


def shadows_without_robot(spec: RunSpec) -> Iterator[Suspicion]:
    """Yield the cameras with a fisheye lens that sees the floor beneath the robot, without the robot."""
    for camera in cameras_of(spec):
        config, render = camera.spec.robot.camera, camera.spec.render
        if config.fisheye is None or config.sees_robot:
            continue
        half_height_deg = 0.5 * config.fisheye.field_of_view_deg * render.height_px / render.width_px
        if config.pitch_down_deg + half_height_deg > MAX_DOWN_DEG:
            place = f"robot.sensors.{camera.name}" if camera.name else "robot.camera"
            yield Suspicion(
                f"{place} shadow",
                f"{place} sees the shadow of the robot on the floor, but not the robot: with {place}.sees_robot=true "
                "images show both",
            )
