"""The rendering of a run as a file: the scene, the views, and every setting on which a pixel depends."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from blender_scenes.lighting.flicker import frame_gains
from blender_scenes.lighting.illuminance import on_the_floor
from blender_scenes.render.devices import DeviceKind
from blender_scenes.render.job_text import JobText
from blender_scenes.render.sampling import TracingSettings, rendering_of, tracing_settings
from blender_scenes.scene.description import Scene
from blender_scenes.scene.run_scene import arena_bounds, describe
from configs.schema.appearance.look import LookConfig
from configs.schema.robot import RobotConfig
from configs.schema.scenario import Render
from sensors.camera.colour import RGB
from sensors.camera.response import CameraResponse
from sensors.camera.shutter import Window, exposed, moment, window
from sensors.camera.views import INSTANT, FrameView
from symolo.arena.geometry import Arena
from symolo.core.geometry.pinhole import Intrinsics, Shutter, intrinsics, pose_X_RC
from symolo.core.geometry.robot_path import RobotPath
from symolo.dataset.layout import frame_name


@dataclass(frozen=True)
class FramePose:
    """Pose of the robot at the time of an image."""

    number: int
    """Image number, from 1."""
    t_s: float
    """Time since the start of the run, which decides where moving obstacles are."""
    x_m: float
    y_m: float
    yaw_rad: float


@dataclass(frozen=True)
class RenderJob(JobText):
    """What a Blender process needs to render the images of a run."""

    FORMAT = 5
    KIND = "render"

    scene: Scene
    camera: Intrinsics
    frames: tuple[FrameView, ...]
    sampling: TracingSettings
    response: CameraResponse
    shutter: Shutter = INSTANT

    def files(self, number: int) -> tuple[str, ...]:
        """Return the names of a frame's files."""
        return (frame_name(number),)


def build_job(  # noqa: PLR0917 - a run's images depend on all of these
    arena: Arena,
    robot: RobotConfig,
    look: LookConfig,
    render: Render,
    frames: Sequence[FramePose],
    seed: int,
    path: RobotPath | None = None,
    device: DeviceKind = "CPU",
    noise_seed: int | None = None,
) -> RenderJob:
    """Return the rendering of a run; the same arguments give the same job.

    Args:
        arena: Arena.
        robot: Robot, whose camera it is.
        look: Look.
        render: Size and quality of the images.
        frames: Poses of the robot.
        seed: Seed of the scene.
        path: Path of the robot, for exposures that take time.
        device: Device that renders.
        noise_seed: Seed of path tracing and camera noise; by default that of the scene.

    Raises:
        ValueError: An exposure takes time and there is no path of the robot, or no camera has such a lens.
    """
    scene = describe(arena, robot, look, seed)
    (x0, y0), (x1, y1) = arena_bounds(arena)
    middle = 0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.0
    light = on_the_floor(scene.panels, middle)
    mains = on_the_floor([panel for panel in scene.panels if panel.on_mains], middle)
    camera = intrinsics(robot.camera, render.width_px, render.height_px)
    shutter = Shutter(look.camera.exposure_time_s, robot.camera.read_out_s)
    noise_seed = seed if noise_seed is None else noise_seed
    times = np.array([frame.t_s for frame in frames])
    gains = frame_gains(look.lamps.flicker, times, shutter.exposure_s, mains, light, seed)
    return RenderJob(
        format=RenderJob.FORMAT,
        scene=scene,
        camera=camera,
        frames=_views(arena, robot, frames, gains, window(shutter, camera), path),
        sampling=tracing_settings(rendering_of(render, robot.camera), noise_seed, device, len(frames)),
        response=CameraResponse.from_look(look.camera, light, noise_seed, render.jpeg_quality, render.width_px),
        shutter=shutter,
    )


def _views(  # noqa: PLR0917 - likewise
    arena: Arena,
    robot: RobotConfig,
    frames: Sequence[FramePose],
    gains: Sequence[RGB],
    exposure: Window,
    path: RobotPath | None,
) -> tuple[FrameView, ...]:
    X_RC = pose_X_RC(robot.camera, robot.chassis.base_height_m)
    views = []
    for frame, gain in zip(frames, gains, strict=True):
        at = moment(arena, X_RC, (frame.x_m, frame.y_m, frame.yaw_rad), frame.t_s)
        views.append(FrameView(frame.number, frame.t_s, at.robot_pose, at.X_WC, at.moving, gain))
    if exposure.length_s == 0:
        return tuple(views)
    if path is None:
        raise ValueError("an exposure time above 0 needs the path of the robot, and there is none")
    return exposed(views, arena, X_RC, path, exposure)
