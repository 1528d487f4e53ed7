"""One picture of each floor, kind of line, wall and obstacle, as the robot's camera sees them, side by side.

python benchmarks/material_page.py [--out materials.png] [--samples 4] [--only carpet brick ...]
"""

import argparse
import tempfile
from pathlib import Path
from typing import get_args

import cv2
import numpy as np

from blender_scenes.frame_files import frame_name
from blender_scenes.job import FramePose, build_job
from blender_scenes.renderer import render_job
from configs.loader import load_section
from configs.schema.arena import ArenaConfig
from configs.schema.floors import FloorName
from configs.schema.look import LookConfig
from configs.schema.robot import RobotConfig
from configs.schema.scenario import Render
from configs.schema.surface import SurfaceName
from physics.arena import Arena

COLUMNS = 4
POSE = FramePose(number=1, t_s=0.0, x_m=0.15, y_m=-0.03, yaw_rad=np.radians(-6.0))
WINDOW = {"side": "north"}  # beside the robot, so that gloss does not hide the pattern
LINE = {
    "pieces": [
        {"kind": "straight", "start": (-0.5, 0.0), "end": (0.4, 0.0)},
        {"kind": "arc", "center": (0.4, 0.3), "radius_m": 0.3, "start_deg": 270, "end_deg": 340},
    ]
}


def looks() -> dict[str, dict[str, object]]:
    """Settings by caption: floors under worn tape, then lines."""
    floors = [name for name in get_args(FloorName) if name != "image"]
    made: dict[str, dict[str, object]] = {
        f"{name} floor": {"floor": {"material": name, "yaw_deg": 20}} for name in floors
    }
    made["terrazzo floor"] = {"floor": {"material": "vinyl", "vinyl": {"print": "terrazzo"}}}
    made["glossy tape"] = {"tape": {"roughness": 0.2, "wear": 0.8, "wrinkles": 0.8, "lift_m": 0.0006}, "window": {}}
    return made | {"paint": {"line": "paint", "window": {}}}


def picture(look: LookConfig, surface: SurfaceName, robot: RobotConfig, samples: int) -> np.ndarray:
    """(240, 320, 3), blue first: a line, an obstacle and a wall, both of `surface`."""
    wall = {"name": "wall", "start": (0.85, -0.8), "end": (0.85, 0.8), "surface": surface}
    obstacle = {"name": "box", "center": (0.5, -0.17), "yaw_deg": 25, "surface": surface}
    config = {"name": "sample", "line": LINE, "walls": [wall], "obstacles": [obstacle]}
    arena = Arena.from_config(ArenaConfig.model_validate(config))
    job = build_job(arena, robot, look, Render(width_px=320, height_px=240, samples=samples), [POSE], seed=3)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "job.json")
        file.write_text(job.to_json())
        render_job(file, Path(folder, "images"), threads=2)
        return cv2.imread(str(Path(folder, "images", frame_name(POSE.number))))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("materials.png"))
    parser.add_argument("--samples", type=int, default=4)
    parser.add_argument("--only", nargs="+", help="captions")
    asked = parser.parse_args()
    robot = RobotConfig.model_validate(load_section("robot", "nominal").tree)
    cells = [(name, settings, "cardboard") for name, settings in looks().items()]
    cells += [(name, {}, name) for name in get_args(SurfaceName)]
    seen = []
    for caption, settings, surface in cells:
        if asked.only and caption not in asked.only:
            continue
        look = LookConfig.model_validate({"name": "sample", "window": WINDOW, **settings})
        cell = picture(look, surface, robot, asked.samples)
        seen.append(cv2.putText(cell, caption, (6, 16), cv2.FONT_HERSHEY_SIMPLEX, 0.5, (40, 40, 230), 1, cv2.LINE_AA))
    seen += [np.zeros_like(seen[0])] * (-len(seen) % COLUMNS)
    rows = [np.hstack(seen[i : i + COLUMNS]) for i in range(0, len(seen), COLUMNS)]
    cv2.imwrite(str(asked.out), np.vstack(rows))


if __name__ == "__main__":
    main()
