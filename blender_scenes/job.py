"""One run's rendering as a file: the scene, the views to be taken, and every setting that decides a pixel."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydantic import TypeAdapter

from blender_scenes.camera import Array, intrinsics, pose_X_RC, pose_X_WR
from blender_scenes.camera_response import CameraResponse
from blender_scenes.description import FrameView, Intrinsics, Matrix4, PlanarPose, Scene
from blender_scenes.lighting.flicker import frame_gains
from blender_scenes.lighting.illuminance import on_the_floor
from blender_scenes.scene import arena_bounds, describe
from configs.schema.look import LookConfig
from configs.schema.robot import RobotConfig
from configs.schema.scenario import Render
from physics.arena import Arena

FORMAT = 1


@dataclass(frozen=True)
class FramePose:
    """Where the robot stood at one shutter."""

    number: int
    """Image number, from 1."""
    t_s: float
    """Since the start of the run; moving obstacles are where they are then."""
    x_m: float
    y_m: float
    yaw_rad: float


@dataclass(frozen=True)
class Sampling:
    """How the light is traced; nothing of it is left to Blender's defaults."""

    seed: int
    samples: int
    denoise: bool
    prefilter: str = "FAST"
    """Of the denoiser's guides; ACCURATE costs 2.5 s a frame at 640 x 480 whatever the samples."""
    denoise_quality: str = "BALANCED"
    diffuse_bounces: int = 3
    glossy_bounces: int = 3
    transmission_bounces: int = 6
    filter_width_px: float = 1.5


@dataclass(frozen=True)
class RenderJob:
    format: int
    scene: Scene
    camera: Intrinsics
    frames: tuple[FrameView, ...]
    sampling: Sampling
    response: CameraResponse

    def to_json(self) -> str:
        """The job as text; equal jobs give equal bytes."""
        return _JOB.dump_json(self).decode() + "\n"

    @classmethod
    def from_json(cls, text: str) -> "RenderJob":
        """The job that `to_json` wrote.

        Raises:
            ValueError: The text is no job, or one of another format.
        """
        job = _JOB.validate_json(text)
        if job.format != FORMAT:
            raise ValueError(f"render job of format {job.format}, expected {FORMAT}; build it again")
        return job


_JOB = TypeAdapter(RenderJob)


def build_job(  # noqa: PLR0917 - a run's pictures depend on all of these
    arena: Arena, robot: RobotConfig, look: LookConfig, render: Render, frames: Sequence[FramePose], seed: int
) -> RenderJob:
    """The rendering of a run; the same arguments give the same job."""
    scene = describe(arena, robot, look, seed)
    (x0, y0), (x1, y1) = arena_bounds(arena)
    middle = 0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.0
    light = on_the_floor(scene.panels, middle)
    mains = on_the_floor([panel for panel in scene.panels if panel.on_mains], middle)
    gains = frame_gains(look.lamps.flicker, np.array([frame.t_s for frame in frames]), mains, light, seed)
    X_RC = pose_X_RC(robot.camera, robot.chassis.base_height_m)
    moving = [box.poses_at(np.array([frame.t_s for frame in frames])) for box in arena.moving]
    views = []
    for i, frame in enumerate(frames):
        X_WC = pose_X_WR(frame.x_m, frame.y_m, frame.yaw_rad) @ X_RC
        pose = frame.x_m, frame.y_m, frame.yaw_rad
        moved = tuple(_planar(poses[i]) for poses in moving)
        views.append(FrameView(frame.number, frame.t_s, pose, _rows(X_WC), moved, gains[i]))
    return RenderJob(
        format=FORMAT,
        scene=scene,
        camera=intrinsics(robot.camera, render.width_px, render.height_px),
        frames=tuple(views),
        sampling=Sampling(seed=seed, samples=render.samples, denoise=render.denoise),
        response=CameraResponse.from_look(look.camera, light, seed, render.jpeg_quality),
    )


def _planar(pose: Array) -> PlanarPose:
    return float(pose[0]), float(pose[1]), float(pose[2])


def _rows(matrix: Array) -> Matrix4:
    a, b, c, d = ((float(r[0]), float(r[1]), float(r[2]), float(r[3])) for r in matrix)
    return a, b, c, d
