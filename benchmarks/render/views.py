"""What the rendering benchmarks look at: the robot on the line of the dataset's arena, under a look."""

from dataclasses import dataclass, replace

import numpy as np

from blender_scenes.job import FramePose, RenderJob, build_job
from configs.draw import draw_run
from configs.loader import load_scenario
from physics.arena import Arena

LOOKS = ("classroom", "lab", "atelier", "garage", "night", "extreme")
POSES = ((0.55, -0.20, 90.0), (0.50, 0.62, 130.0), (-0.10, 0.75, 180.0), (-0.62, 0.0, 265.0), (0.30, -1.0, 20.0))
"""x [m], y [m], yaw [deg] in the dataset's arena."""


@dataclass(frozen=True)
class Views:
    """A look's pictures of sharp, steady moments: light paths are compared, not shutters."""

    look: str
    job: RenderJob
    """Without camera noise."""
    shot_noise: float
    read_noise: float
    """What the look draws."""

    def noisy(self) -> RenderJob:
        return replace(
            self.job, response=replace(self.job.response, shot_noise=self.shot_noise, read_noise=self.read_noise)
        )


def views_of(look: str, poses: tuple[tuple[float, float, float], ...], size: tuple[int, int]) -> Views:
    """The first run's draw of a look, seen from each pose."""
    width, height = size
    settings = [f"look={look}", "look.camera.exposure_time_s=0"]
    settings += [f"render.width_px={width}", f"render.height_px={height}"]
    spec = draw_run(load_scenario("symolo", settings), "CW", 1)
    frames = [FramePose(i + 1, 0.2 * i, x, y, float(np.radians(yaw))) for i, (x, y, yaw) in enumerate(poses)]
    job = build_job(Arena.from_config(spec.arena), spec.robot, spec.look, spec.render, frames, 1)
    noise = job.response.shot_noise, job.response.read_noise
    return Views(look, replace(job, response=replace(job.response, shot_noise=0.0, read_noise=0.0)), *noise)
