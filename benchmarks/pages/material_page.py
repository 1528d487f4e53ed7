"""One image of each floor, kind of line, wall and obstacle, as the robot's camera sees them, side by side.

python benchmarks/pages/material_page.py FOLDER [--samples 4] [--only carpet brick ...]
    [--each docs/reference/materials]
"""

import argparse
from pathlib import Path
from typing import get_args

import cv2
from sample_page import POSE, nominal_robot, rendered_images, sample_arena, save_page

from blender_scenes.render.job import build_job
from configs.schema.appearance.floors import FloorName
from configs.schema.appearance.look import LookConfig
from configs.schema.appearance.surface import SurfaceName
from configs.schema.robot import RobotConfig
from configs.schema.scenario import Render

COLUMNS = 4
WINDOW = {"side": "north"}  # beside the robot, so that gloss does not hide the pattern
FROM_ABOVE = {"streaked tape"}
"""Captions of what is too fine for the robot's camera; one 8 cm above the floor looks down on it."""


def looks() -> dict[str, dict[str, object]]:
    """Return settings by caption: floors under worn tape, then lines."""
    floors = [name for name in get_args(FloorName) if name != "image"]
    made: dict[str, dict[str, object]] = {
        f"{name} floor": {"floor": {"material": name, "yaw_deg": 20}} for name in floors
    }
    made["terrazzo floor"] = {"floor": {"material": "vinyl", "vinyl": {"print": "terrazzo"}}}
    made["stained floor"] = {"floor": {"material": "ceramic_tile", "yaw_deg": 20, "stains": 0.8}}
    made["glossy tape"] = {"tape": {"roughness": 0.2, "wear": 0.8, "wrinkles": 0.8, "lift_m": 0.0006}, "window": {}}
    made["streaked tape"] = {"tape": {"roughness": 0.2, "streaks": 0.8}, "window": {}}
    return made | {"paint": {"line": "paint", "window": {}}}


def looking_down(robot: RobotConfig) -> RobotConfig:
    mounted = {"x_m": -0.25, "height_above_base_m": 0.08 - robot.chassis.base_height_m, "pitch_down_deg": 80.0}
    return robot.model_copy(update={"camera": robot.camera.model_copy(update=mounted)})


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="gets materials.png, and the images, to go on from")
    parser.add_argument("--samples", type=int, default=4)
    parser.add_argument("--only", nargs="+", help="captions")
    parser.add_argument("--each", type=Path, help="gets each image as a small JPEG too")
    options = parser.parse_args()
    robot, render = nominal_robot(), Render(width_px=320, height_px=240, samples=options.samples)
    cells: list[tuple[str, dict[str, object], SurfaceName]] = [
        (name, settings, "cardboard") for name, settings in looks().items()
    ]
    cells += [(f"{name} wall", {}, name) for name in get_args(SurfaceName)]
    seen = {}
    for caption, settings, surface in cells:
        if not options.only or caption in options.only:
            look = LookConfig.model_validate({"name": "sample", "window": WINDOW, **settings})
            seen_by = looking_down(robot) if caption in FROM_ABOVE else robot
            job = build_job(sample_arena(surface), seen_by, look, render, [POSE], seed=3)
            seen[caption] = rendered_images(job, options.folder / caption.replace(" ", "_"))
    save_page(seen, COLUMNS, options.folder / "materials.png")
    if options.each:
        options.each.mkdir(parents=True, exist_ok=True)
        for caption, (image,) in seen.items():
            cv2.imwrite(str(options.each / f"{caption.replace(' ', '_')}.jpg"), image, [cv2.IMWRITE_JPEG_QUALITY, 80])


if __name__ == "__main__":
    main()
