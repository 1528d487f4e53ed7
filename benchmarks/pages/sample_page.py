"""The common part of the pages of materials and of lights: the sample scene, its images, and their sheet."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from blender_scenes.render.job import FramePose, RenderJob
from blender_scenes.render.renderer import render_job
from configs.loader import load_section
from configs.schema.appearance.surface import SurfaceName
from configs.schema.arena import ArenaConfig
from configs.schema.robot import RobotConfig
from symolo.arena.geometry import Arena
from symolo.dataset.layout import frame_name
from symolo.pages.sheet import Cell, in_columns, save

Image = NDArray[np.uint8]

POSE = FramePose(number=1, t_s=0.0, x_m=0.15, y_m=-0.03, yaw_rad=float(np.radians(-6.0)))
LINE = {
    "pieces": [
        {"kind": "straight", "start": (-0.5, 0.0), "end": (0.4, 0.0)},
        {"kind": "arc", "center": (0.4, 0.3), "radius_m": 0.3, "start_deg": 270, "end_deg": 340},
    ]
}


def sample_arena(surface: SurfaceName) -> Arena:
    """Return an arena with a line, and with an obstacle and a wall of `surface`."""
    wall = {"name": "wall", "start": (0.85, -0.8), "end": (0.85, 0.8), "surface": surface}
    obstacle = {"name": "box", "center": (0.5, -0.17), "yaw_deg": 25, "surface": surface}
    config = {"name": "sample", "line": LINE, "walls": [wall], "obstacles": [obstacle]}
    return Arena.from_config(ArenaConfig.model_validate(config))


def nominal_robot() -> RobotConfig:
    return RobotConfig.model_validate(load_section("robot", "nominal").tree)


def rendered_images(job: RenderJob, folder: Path) -> list[Image]:
    """Return the job's images (H, W, 3), blue first; those that are missing in `folder` are rendered."""
    folder.mkdir(parents=True, exist_ok=True)
    file, images_dir = folder / "job.json", folder / "images"
    file.write_text(job.to_json())
    render_job(file, images_dir, threads=2)
    return [np.asarray(cv2.imread(str(images_dir / frame_name(view.number))), np.uint8) for view in job.frames]


def save_page(captioned: Mapping[str, Sequence[Image]], columns: int, path: Path) -> None:
    """Save a page of cells, each with its images below one another and a caption."""
    if not captioned:
        raise SystemExit("no such caption")
    cells = [Cell(np.vstack(images), (caption,)) for caption, images in captioned.items()]
    save(in_columns(cells, columns), path)
