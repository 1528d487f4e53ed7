"""Labelled frames for a camera that looks down on a line: geometry drawn once, seen under any look.

The label is the place, in the image, of the line's centre line at given rows: projected through the lens, never read
off the pixels. Scene number N has the same line, camera and places under every look; only the look differs.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from blender_scenes.preview.renderer import FlatRenderer
from blender_scenes.render.job import FramePose, RenderJob, build_job
from blender_scenes.render.renderer import render_job
from configs.draw import draw_run
from configs.loader import LoadedScenario, load_scenario
from configs.schema.arena import ArenaConfig
from configs.schema.robot import LensDistortion, RobotConfig
from pipeline.run_folder.user_image_copies import copy_user_images
from symolo.arena.geometry import Arena
from symolo.core.geometry.pinhole import Intrinsics, intrinsics, pose_X_RC, project
from symolo.core.geometry.poses import pose_X_WR
from symolo.core.random_streams import stream
from symolo.dataset.layout import frame_name

Array = NDArray[np.float64]

WIDTH_PX, HEIGHT_PX = 160, 120
ROWS = (31.5, 59.5, 87.5)
"""Rows of the labels [px], 0 is the middle of the first row; symmetric from the top and from the bottom."""
_INSIDE_PX = 6.0
"""Smallest distance of a label from the image's left and right border."""
_SEED = 20


@dataclass(frozen=True)
class LabelledFrames:
    """Images of several scenes."""

    images: NDArray[np.uint8]
    """(N, H, W, 3), blue first."""
    x_px: Array
    """(N, len(ROWS)) of the centre line; NaN where it has no one place in that row."""
    group: NDArray[np.int64]
    """(N,) number of the scene; frames of one scene have their look in common."""


@dataclass(frozen=True)
class Kind:
    """A kind of frames: a look with overrides."""

    look: str
    overrides: tuple[str, ...] = ()
    view: str | None = None
    """Scenario whose camera and width of the line all scenes have; None for others in each scene."""

    def scenario(self) -> LoadedScenario:
        images = (f"render.width_px={WIDTH_PX}", f"render.height_px={HEIGHT_PX}", "render.samples=4")
        return load_scenario("symolo", (f"look={self.look}", *images, "look.camera.exposure_time_s=0", *self.overrides))


def frames(kind: Kind, scenes: range, count: int, folder: Path, threads: int) -> LabelledFrames:
    """Return `count` frames of each scene; those that are missing in `folder` are path-traced."""
    loaded, view = kind.scenario(), None if kind.view is None else load_scenario(kind.view)
    images, labels = [], []
    for scene in scenes:
        job, label = labelled_job(loaded, scene, count, view)
        place = folder / f"scene_{scene}"
        place.mkdir(parents=True, exist_ok=True)
        (place / "job.json").write_text(job.to_json())
        copy_user_images((draw_run(loaded, loaded.routes[0].name, scene + 1).look,), loaded.assets, folder / "assets")
        render_job(place / "job.json", place / "images", threads=threads, user_files=folder / "assets")
        names = [place / "images" / frame_name(view.number) for view in job.frames]
        images += [cv2.imread(str(name)) for name in names]
        labels.append(label)
    return LabelledFrames(np.array(images, np.uint8), np.concatenate(labels), np.repeat(np.array(scenes), count))


def flat_frames(kind: Kind, scenes: range, count: int) -> LabelledFrames:
    """Return the same frames by the flat renderer: without texture, gloss and shadows of lamps."""
    loaded = kind.scenario()
    images, labels = [], []
    for scene in scenes:
        job, label = labelled_job(loaded, scene, count)
        renderer = FlatRenderer(job)
        images += [renderer.image(view)[..., ::-1] for view in job.frames]
        labels.append(label)
    return LabelledFrames(np.array(images, np.uint8), np.concatenate(labels), np.repeat(np.array(scenes), count))


def labelled_job(
    loaded: LoadedScenario, scene: int, count: int, view: LoadedScenario | None = None
) -> tuple[RenderJob, Array]:
    """Return the render job of a scene, and its labels (count, len(ROWS)) [px]."""
    spec = draw_run(loaded, loaded.routes[0].name, scene + 1)
    rng = stream(_SEED, "geometry", scene)
    robot = _with_line_camera(spec.robot, rng)
    line = _line(rng, robot, None)
    if view is not None:
        seen = draw_run(view, view.routes[0].name, scene + 1)
        mounted = seen.robot.camera.model_copy(update={"x_m": robot.camera.x_m})
        robot = robot.model_copy(update={"camera": mounted})
        line = _line(stream(_SEED, "geometry of a view", scene), robot, seen.arena.line.width_m)
    arena = Arena.from_config(line)
    camera = intrinsics(robot.camera, WIDTH_PX, HEIGHT_PX)
    X_RC = pose_X_RC(robot.camera, robot.chassis.base_height_m)
    poses: list[FramePose] = []
    labels: list[Array] = []
    while len(poses) < count:
        pose = _pose(rng, arena, robot, len(poses) + 1)
        label = centre_line(camera, pose_X_WR(pose.x_m, pose.y_m, pose.yaw_rad) @ X_RC, arena, ROWS)
        if np.isfinite(label).all():
            poses.append(pose)
            labels.append(label)
    return build_job(arena, robot, spec.look, spec.render, poses, scene), np.array(labels)


def centre_line(camera: Intrinsics, X_WC: Array, arena: Arena, rows: Sequence[float]) -> Array:
    """Return where the middle of the main line crosses the rows, (len(rows),) [px].

    It is NaN where the line crosses a row not exactly once, or too far aside.
    """
    points = np.concatenate([p.at(np.linspace(0, p.length_m, 400)) for p in arena.line.pieces[:2]])
    pixels, depth = project(camera, X_WC, np.column_stack([points, np.zeros(len(points))]))
    u, v = np.where(depth[:, None] > 0.01, pixels, np.nan).T
    crossing_px = np.full(len(rows), np.nan)
    for number, row in enumerate(rows):
        at = np.flatnonzero((v[:-1] - row) * (v[1:] - row) < 0)
        crossings = u[at] + (row - v[at]) / (v[at + 1] - v[at]) * (u[at + 1] - u[at])
        inside = crossings[(crossings > -0.5 * WIDTH_PX) & (crossings < 1.5 * WIDTH_PX)]
        if len(inside) == 1 and _INSIDE_PX <= inside[0] <= WIDTH_PX - 1 - _INSIDE_PX:
            crossing_px[number] = inside[0]
    return crossing_px


def _with_line_camera(robot: RobotConfig, rng: np.random.Generator) -> RobotConfig:
    """Return a robot with a camera on a boom ahead of it, 9 to 16 cm above the floor, with a cheap lens."""
    height_m, pitch_deg, focal_mm = rng.uniform(0.09, 0.16), rng.uniform(72, 90), rng.uniform(25, 36)
    corner = 0.5 * robot.camera.sensor_width_mm * np.hypot(1, HEIGHT_PX / WIDTH_PX) / focal_mm
    # r + k1 r^3 reaches the corner before it folds back where k1 > -4 / (27 corner^2).
    k1 = max(rng.uniform(-0.2, 0.02), -0.95 * 4 / (27 * corner**2))
    mounted = {
        "x_m": 0.2,
        "height_above_base_m": height_m - robot.chassis.base_height_m,
        "pitch_down_deg": pitch_deg,
        "focal_length_mm": focal_mm,
        "distortion": LensDistortion(k1=k1),
    }
    return robot.model_copy(update={"camera": robot.camera.model_copy(update=mounted)})


def _line(rng: np.random.Generator, robot: RobotConfig, width_m: float | None) -> ArenaConfig:
    """Return a straight that continues in a bend, and a branch at right angles that ends at the main line."""
    camera = robot.camera
    height_m = robot.chassis.base_height_m + camera.height_above_base_m
    if width_m is None:
        drawn_m = rng.uniform(0.14, 0.32) * height_m * camera.sensor_width_mm / camera.focal_length_mm
        width_m = min(drawn_m, 0.1)
    radius_m, bend_sign = float(np.exp(rng.uniform(np.log(0.25), np.log(2.0)))), rng.choice([-1.0, 1.0])
    turned = np.degrees(0.5 / radius_m)
    bend = {"kind": "arc", "center": (0.0, bend_sign * radius_m), "radius_m": radius_m}
    bend |= {"start_deg": -90 * bend_sign, "end_deg": bend_sign * (turned - 90)}
    away, edge_m = rng.choice([-1.0, 1.0]), 0.5 * width_m + rng.uniform(0, 0.004)
    branch = {"kind": "straight", "start": (-0.35, away * edge_m), "end": (-0.35, away * 0.4)}
    pieces = [{"kind": "straight", "start": (-0.7, 0.0), "end": (0.0, 0.0)}, bend, branch]
    return ArenaConfig.model_validate({"name": "line", "line": {"width_m": width_m, "pieces": pieces}})


def _pose(rng: np.random.Generator, arena: Arena, robot: RobotConfig, number: int) -> FramePose:
    """Return a pose from which the camera looks near the line, turned by up to 50 deg.

    In a third of the cases it looks at the place where the branch begins.
    """
    straight, bend = arena.line.pieces[:2]
    near_branch = rng.random() < 1 / 3
    s_m = 0.35 + rng.uniform(-0.06, 0.06) if near_branch else rng.uniform(0.1, 1.1)
    piece, s_m = (straight, s_m) if s_m < straight.length_m else (bend, s_m - straight.length_m)
    height_m = robot.chassis.base_height_m + robot.camera.height_above_base_m
    aside_m = rng.uniform(-0.5, 0.5) * height_m
    (x0, y0), (x1, y1) = piece.at(np.array([s_m, s_m + 1e-4]))
    along = np.arctan2(y1 - y0, x1 - x0) + (np.pi if rng.random() < 1 / 2 else 0.0)
    yaw = along + np.radians(rng.uniform(-50, 50))
    ahead_m = robot.camera.x_m + height_m / np.tan(np.radians(robot.camera.pitch_down_deg))
    x_m = x0 - aside_m * np.sin(along) - ahead_m * np.cos(yaw)
    y_m = y0 + aside_m * np.cos(along) - ahead_m * np.sin(yaw)
    return FramePose(number, 0.0, float(x_m), float(y_m), float(yaw))
