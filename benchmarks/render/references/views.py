"""Views for the rendering benchmarks: the robot in the dataset's arena, under a look."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from blender_scenes.render.job import FramePose, RenderJob, build_job
from blender_scenes.scene.run_scene import arena_bounds
from configs.draw import draw_run
from configs.loader import load_scenario
from configs.schema.scenario import RunSpec
from symolo.arena.geometry import Arena
from symolo.core.random_streams import stream

LOOKS = ("classroom", "lab", "atelier", "garage", "night", "extreme")
POSES = ((0.55, -0.20, 90.0), (0.50, 0.62, 130.0), (-0.10, 0.75, 180.0), (-0.62, 0.0, 265.0), (0.30, -1.0, 20.0))
"""x [m], y [m], yaw [deg] in the dataset's arena."""
_STEP_M = 0.032
_TURN_DEG = 3.0
"""Distance and turn of the robot between two images, at 5 images a second on a bend."""
_MAX_TRIES = 8
"""Random places for each one that is needed, as some have no free place ahead."""
_CLEAR_M = 0.13
"""Minimum distance of the robot's middle from walls and obstacles."""
_PITCHES_DEG = 15.0, 60.0
"""Range of random angles of the camera below the horizon."""


@dataclass(frozen=True)
class Views:
    """Views under a look, without an exposure time, since light paths are compared and not shutters."""

    look: str
    job: RenderJob
    """Job without camera noise."""
    shot_noise: float
    read_noise: float
    """Noise of the camera that the look draws."""

    def noisy(self) -> RenderJob:
        """Return the job with the noise of the camera."""
        return replace(
            self.job, response=replace(self.job.response, shot_noise=self.shot_noise, read_noise=self.read_noise)
        )


def views_of(look: str, poses: tuple[tuple[float, float, float], ...], size: tuple[int, int]) -> Views:
    """Return the first run's draw of a look, seen from each pose."""
    return _views(look, drawn(look, size), poses)


@dataclass(frozen=True)
class RandomCase:
    """A new draw of a look, with a random camera."""

    look: str
    number: int
    """Number of the draw, from 1."""
    seed: int

    @property
    def name(self) -> str:
        return f"{self.look} {self.number}"

    def views(self, poses: int, size: tuple[int, int]) -> Views:
        """Return images from random places beside walls and obstacles, in all directions."""
        spec = self.spec(size)
        seed = int(stream(self.seed, self.look, self.number, "render").integers(2**31))
        return _views(self.look, spec, self._poses(spec, poses), seed)

    def repeated_views(self, places: int, size: tuple[int, int]) -> Views:
        """Return three images from each of some random places: two of the same pose, and one from a step further on.

        All have the same time, so nothing but the camera, and what it is mounted on, has moved.
        """
        spec = self.spec(size)
        arena = Arena.from_config(spec.arena)
        poses: list[tuple[float, float, float]] = []
        for x, y, yaw_deg in self._poses(spec, _MAX_TRIES * places):
            middle = np.radians(yaw_deg + 0.5 * _TURN_DEG)
            ahead = x + _STEP_M * float(np.cos(middle)), y + _STEP_M * float(np.sin(middle))
            if is_clear(arena, *ahead) and len(poses) < 3 * places:
                poses += [(x, y, yaw_deg), (x, y, yaw_deg), (*ahead, yaw_deg + _TURN_DEG)]
        seed = int(stream(self.seed, self.look, self.number, "render").integers(2**31))
        return _views(self.look, spec, poses, seed, interval_s=0.0)

    def spec(self, size: tuple[int, int]) -> RunSpec:
        pitch_deg = stream(self.seed, self.look, self.number, "pitch").uniform(*_PITCHES_DEG)
        settings = [f"seed={self.seed}", f"robot.camera.pitch_down_deg={pitch_deg:.1f}"]
        return drawn(self.look, size, settings, self.number)

    def _poses(self, spec: RunSpec, count: int) -> list[tuple[float, float, float]]:
        random = stream(self.seed, self.look, self.number, "poses")
        arena = Arena.from_config(spec.arena)
        low, high = arena_bounds(arena)
        poses: list[tuple[float, float, float]] = []
        while len(poses) < count:
            x, y = random.uniform(low, high)
            if is_clear(arena, x, y):
                poses.append((x, y, random.uniform(-180, 180)))
        return poses


def random_cases(looks: Sequence[str], draws: int, seed: int) -> list[RandomCase]:
    """Return one draw of each look, and as many as `draws` of `extreme`."""
    shipped = [RandomCase(look, 1, seed) for look in looks if look != "extreme"]
    return shipped + [RandomCase("extreme", number + 1, seed) for number in range(draws)]


def is_clear(arena: Arena, x_m: float, y_m: float) -> bool:
    """Return whether the robot fits on a place of the floor."""
    for box in arena.boxes:
        cosine, sine = np.cos(box.yaw_rad), np.sin(box.yaw_rad)
        x, y = x_m - box.center[0], y_m - box.center[1]
        beyond = abs(cosine * x + sine * y) - 0.5 * box.size[0], abs(cosine * y - sine * x) - 0.5 * box.size[1]
        if np.hypot(*np.maximum(beyond, 0)) < _CLEAR_M:
            return False
    return True


def _views(
    look: str, spec: RunSpec, poses: Sequence[tuple[float, float, float]], seed: int = 1, interval_s: float = 0.2
) -> Views:
    frames = [FramePose(i + 1, interval_s * i, x, y, float(np.radians(yaw))) for i, (x, y, yaw) in enumerate(poses)]
    job = build_job(Arena.from_config(spec.arena), spec.robot, spec.look, spec.render, frames, seed)
    noise = job.response.shot_noise, job.response.read_noise
    return Views(look, replace(job, response=replace(job.response, shot_noise=0.0, read_noise=0.0)), *noise)


def job_along_the_line(look: str, frames: int, size: tuple[int, int]) -> RenderJob:
    """Return the job of a robot that follows the line without error at 0.16 m/s, with 5 images a second, for many laps.

    It leaves out the places at which it would be inside an obstacle.
    """
    spec = drawn(look, size)
    arena = Arena.from_config(spec.arena)
    pieces = arena.line.pieces
    ends = np.cumsum([piece.length_m for piece in pieces])
    poses: list[FramePose] = []
    at_m = -_STEP_M
    while len(poses) < frames:
        at_m = (at_m + _STEP_M) % ends[-1]
        k = int(np.searchsorted(ends, at_m, side="right"))
        along = np.clip(at_m - ends[k] + pieces[k].length_m + np.array([-1e-3, 0, 1e-3]), 0, pieces[k].length_m)
        behind, here, ahead = pieces[k].at(along, np.zeros(3))
        yaw, number = np.arctan2(*(ahead - behind)[::-1]), len(poses)
        if is_clear(arena, here[0], here[1]):
            poses.append(FramePose(number + 1, 0.2 * number, float(here[0]), float(here[1]), float(yaw)))
    return build_job(arena, spec.robot, spec.look, spec.render, poses, 1)


def drawn(look: str, size: tuple[int, int], settings: Sequence[str] = (), run: int = 1) -> RunSpec:
    """Return a run of the dataset's scenario under a look, without an exposure time."""
    width, height = size
    fixed = [f"look={look}", "look.camera.exposure_time_s=0", "render.method=full"]
    fixed += [f"render.width_px={width}", f"render.height_px={height}"]
    return draw_run(load_scenario("symolo", [*fixed, *settings]), "CW", run)
