"""A small arena with a pane of glass, an obstacle before a wall and one that moves, annotated once for all tests."""

from dataclasses import dataclass
from pathlib import Path
from typing import get_args

import cv2
import numpy as np
import pytest

from blender_scenes.annotations.document import document
from blender_scenes.annotations.job import AnnotationJob, build_annotation_job
from blender_scenes.annotations.record import FrameRecord
from blender_scenes.render.job import FramePose, RenderJob, build_job
from blender_scenes.render.renderer import render_job
from configs.schema.appearance.look import LookConfig
from configs.schema.arena import ArenaConfig
from configs.schema.scenario import Render
from symolo.arena.geometry import Arena
from symolo.dataset.annotations import AnnotationDocument, AnnotationName

ARENA = {
    "name": "small",
    "line": {"pieces": [{"kind": "straight", "start": [0.0, 0.0], "end": [1.2, 0.0]}]},
    "walls": [
        {"name": "pane", "start": [1.0, 0.35], "end": [1.0, -0.05], "surface": "glass"},
        {"name": "board", "start": [1.3, 0.6], "end": [1.3, -0.6]},
    ],
    "obstacles": [
        {"name": "cube", "center": [0.75, 0.2], "size": [0.1, 0.1, 0.1], "yaw_deg": 20},
        {
            "name": "cart",
            "center": [0.6, -0.25],
            "size": [0.12, 0.08, 0.09],
            "motion": {"waypoints": [{"t_s": 1.0, "offset": [0.3, 0.1], "turn_deg": 50}]},
        },
    ],
}
POSES = ((-0.05, 0.0, 0.0), (0.0, 0.01, 0.05), (0.05, -0.01, -0.1))


@dataclass(frozen=True)
class Annotated:
    arena: Arena
    job: AnnotationJob
    folder: Path
    document: AnnotationDocument

    def image(self, kind: str, number: int) -> np.ndarray:
        """As a stranger reads it, channels in the order of the file."""
        pixels = cv2.imread(str(self.folder / kind / f"{number:06d}.png"), cv2.IMREAD_UNCHANGED)
        return pixels if pixels.ndim == 2 else pixels[..., ::-1]

    def depth_m(self, number: int) -> np.ndarray:
        return self.image("depth", number) / 10_000

    def id_of(self, name: str) -> int:
        return next(one.id for one in self.document.instances if one.name == name)

    def X_WC(self, number: int) -> np.ndarray:
        return np.array(self.document.images[number - 1].X_WC)

    def corners_W(self, name: str, number: int) -> np.ndarray:
        """(8, 3), the lower four first, counter-clockwise from -x', -y'; by trigonometry from the arena's own path."""
        box = next(box for box in self.arena.boxes if box.name == name)
        x, y, yaw = box.poses_at(np.array([self.document.images[number - 1].t_s]))[0]
        c, s = np.cos(yaw), np.sin(yaw)
        length, width, height = box.size
        return np.array(
            [
                (x + c * a - s * b, y + s * a + c * b, z)
                for z in (0.0, height)
                for a, b in (
                    (-length / 2, -width / 2),
                    (length / 2, -width / 2),
                    (length / 2, width / 2),
                    (-length / 2, width / 2),
                )
            ]
        )


@pytest.fixture(scope="session")
def small() -> Arena:
    return Arena.from_config(ArenaConfig.model_validate(ARENA))


@pytest.fixture(scope="session")
def images_job(small, robot) -> RenderJob:
    frames = [FramePose(i + 1, 0.2 * i, *pose) for i, pose in enumerate(POSES)]
    # Looking less far down than the shipped robot, so that the tops of things are in the image.
    camera = robot.camera.model_copy(update={"pitch_down_deg": 12.0})
    robot = robot.model_copy(update={"camera": camera})
    return build_job(small, robot, LookConfig(name="plain"), Render(width_px=96, height_px=72), frames, seed=1)


@pytest.fixture(scope="session")
def annotated(small, images_job, tmp_path_factory) -> Annotated:
    job = build_annotation_job(images_job, small, get_args(AnnotationName))
    folder = tmp_path_factory.mktemp("annotated")
    (folder / "job.json").write_text(job.to_json())
    heard = []
    assert render_job(folder / "job.json", folder / "files", work="annotations", on_frame=heard.append).made == 3
    assert heard == [1, 2, 3]
    records = [FrameRecord.from_json((folder / f"files/records/{n:06d}.json").read_bytes()) for n in heard]
    return Annotated(small, job, folder / "files", document(job, "images", records))
