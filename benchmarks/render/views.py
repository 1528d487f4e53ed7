"""What the rendering benchmarks look at: the robot on the line of the dataset's arena, under a look."""

from dataclasses import dataclass, replace

import numpy as np

from blender_scenes.render.job import FramePose, RenderJob, build_job
from configs.draw import draw_run
from configs.loader import load_scenario
from configs.schema.scenario import RunSpec
from symolo.arena.geometry import Arena

LOOKS = ("classroom", "lab", "atelier", "garage", "night", "extreme")
POSES = ((0.55, -0.20, 90.0), (0.50, 0.62, 130.0), (-0.10, 0.75, 180.0), (-0.62, 0.0, 265.0), (0.30, -1.0, 20.0))
"""x [m], y [m], yaw [deg] in the dataset's arena."""
_STEP_M = 0.032


@dataclass(frozen=True)
class Views:
    """A look's images of sharp, steady moments: light paths are compared, not shutters."""

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
    spec = _drawn(look, size)
    frames = [FramePose(i + 1, 0.2 * i, x, y, float(np.radians(yaw))) for i, (x, y, yaw) in enumerate(poses)]
    job = build_job(Arena.from_config(spec.arena), spec.robot, spec.look, spec.render, frames, 1)
    noise = job.response.shot_noise, job.response.read_noise
    return Views(look, replace(job, response=replace(job.response, shot_noise=0.0, read_noise=0.0)), *noise)


def job_along_the_line(look: str, frames: int, size: tuple[int, int]) -> RenderJob:
    """A robot that follows the line without error, 0.16 m/s and 5 images a second, round after round."""
    spec = _drawn(look, size)
    arena = Arena.from_config(spec.arena)
    pieces = arena.line.pieces
    ends = np.cumsum([piece.length_m for piece in pieces])
    poses = []
    for number in range(frames):
        at_m = number * _STEP_M % ends[-1]
        k = int(np.searchsorted(ends, at_m, side="right"))
        along = np.clip(at_m - ends[k] + pieces[k].length_m + np.array([-1e-3, 0, 1e-3]), 0, pieces[k].length_m)
        behind, here, ahead = pieces[k].at(along, np.zeros(3))
        yaw = np.arctan2(*(ahead - behind)[::-1])
        poses.append(FramePose(number + 1, 0.2 * number, float(here[0]), float(here[1]), float(yaw)))
    return build_job(arena, spec.robot, spec.look, spec.render, poses, 1)


def _drawn(look: str, size: tuple[int, int]) -> RunSpec:
    width, height = size
    settings = [f"look={look}", "look.camera.exposure_time_s=0", "render.method=full"]
    settings += [f"render.width_px={width}", f"render.height_px={height}"]
    return draw_run(load_scenario("symolo", settings), "CW", 1)
