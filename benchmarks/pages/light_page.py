"""The same corner of one room under each kind of light: above across the room, below as the robot's camera sees it.

python benchmarks/pages/light_page.py FOLDER [--samples 16] [--only "tubes" "desk lamp" ...]
"""

import argparse
from dataclasses import replace
from pathlib import Path
from typing import get_args

import numpy as np
from sample_page import POSE, nominal_robot, rendered_images, sample_arena, save_page

from blender_scenes.render.job import RenderJob, build_job
from configs.schema.appearance.lighting import PanoramaName
from configs.schema.appearance.look import LookConfig
from configs.schema.scenario import Render
from sensors.camera.views import FrameView

COLUMNS = 6
ROOM = {"furniture": {"tables": 2, "chairs": 3, "shelves": 1, "cartons": 1, "posters": 2, "door": True}}
EYE, TARGET = (-1.6, -1.5, 1.45), (0.9, 0.6, 0.75)
"""Eye and target of the view across the room [m], towards the window's corner."""
SEED = 3
NIGHT = {"sky": {"panorama": "night", "luminance_kcd_m2": 0.001}, "sun": {"illuminance_klx": 0}}
NO_LAMPS = {"lamps": {"flux_klm": 0}}
OVERCAST = {"sun": {"illuminance_klx": 0}} | NO_LAMPS
FIXED_WHITE = {"white_balance_adaption": 0, "white_balance_K": 4500}
"""So that the colour of the light is seen."""
TUBES = {"rows": 2, "columns": 2, "length_m": 1.2, "width_m": 0.038, "housing": "batten", "drop_m": 0.3}
MAGNETIC = {"depth": 0.5, "mains_hz": 50.02}
PENDANT = {"rows": 1, "columns": 1, "width_m": 0.12, "housing": "shade", "drop_m": 0.7, "color_temperature_K": 2700}
Settings = dict[str, dict[str, object]]


def lights() -> dict[str, Settings]:
    """Return settings by caption; settings that are missing have the schema's default, by day with lamps."""
    made: dict[str, Settings] = {
        "sun and sky": {"sun": {"illuminance_klx": 8, "elevation_deg": 40}} | NO_LAMPS,
        "low sun": {"sun": {"illuminance_klx": 4, "elevation_deg": 22, "color_temperature_K": 3600}} | NO_LAMPS,
        "sun through a curtain": {"window": {"covering": "sheer"}, "sun": {"illuminance_klx": 8}} | NO_LAMPS,
        "sun through blinds": {
            "window": {"covering": "blinds", "slat_tilt_deg": 10},
            "sun": {"illuminance_klx": 8, "elevation_deg": 25},
        }
        | NO_LAMPS,
        "blinds, shut": {"window": {"covering": "blinds", "slat_tilt_deg": -60}, "sun": {"illuminance_klx": 8}},
    }
    for name in get_args(PanoramaName):
        made[f"sky {name}"] = OVERCAST | {"sky": {"panorama": name}}
    for kelvin in (2700, 4000, 6500):
        made[f"panels {kelvin} K"] = NIGHT | {"lamps": {"color_temperature_K": kelvin}, "camera": FIXED_WHITE}
    return made | {
        "tubes": NIGHT | {"lamps": TUBES},
        "tubes, flicker at its height": NIGHT | {"lamps": TUBES | {"flicker": MAGNETIC}},
        "tubes, flicker at its depth": NIGHT | {"lamps": TUBES | {"flicker": MAGNETIC}},
        "pendants": NIGHT | {"lamps": PENDANT | {"rows": 2, "columns": 2, "flux_klm": 1.2}},
        "desk lamps": NIGHT | NO_LAMPS | {"desk_lamps": {"count": 2}},
        "night, one lamp": NIGHT | {"lamps": PENDANT | {"flux_klm": 0.3}},
        "window and warm lamps": {"lamps": {"color_temperature_K": 2700}, "sun": {"illuminance_klx": 0}},
    }


def across_the_room() -> np.ndarray:
    """Return the pose X_WC (4, 4) of a camera at `EYE` that looks at `TARGET`."""
    forward = np.subtract(TARGET, EYE)
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    X_WC = np.eye(4)
    X_WC[:3] = np.column_stack([right, np.cross(forward, right), forward, EYE])
    return X_WC


def page_job(caption: str, settings: Settings, samples: int) -> RenderJob:
    """Return a job of two frames, across the room and from the robot, each with its own exposure unless lamps
    flicker."""
    flickers = "flicker" in caption
    camera = {"exposure_adaption": 0 if flickers else 1, **settings.get("camera", {})}
    look = LookConfig.model_validate({"name": "sample", "room": ROOM, **settings, "camera": camera})
    times = [POSE.t_s] if not flickers else np.linspace(0, 0.01, 21).tolist()
    poses = [replace(POSE, number=n + 1, t_s=t) for n, t in enumerate(times)]
    render = Render(width_px=240, height_px=180, samples=samples)
    job = build_job(sample_arena("cardboard"), nominal_robot(), look, render, poses, SEED)

    def gain(view: FrameView) -> float:
        return view.light_gain[1]

    view = min(job.frames, key=gain) if caption.endswith("depth") else max(job.frames, key=gain)
    rows = tuple(tuple(row) for row in across_the_room().tolist())
    return replace(job, frames=(replace(view, number=1, X_WC=rows), replace(view, number=2)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="gets lights.png, and the images, to go on from")
    parser.add_argument("--samples", type=int, default=16)
    parser.add_argument("--only", nargs="+", help="captions")
    options = parser.parse_args()
    chosen = {name: settings for name, settings in lights().items() if not options.only or name in options.only}
    seen = {}
    for caption, settings in chosen.items():
        seen[caption] = rendered_images(
            page_job(caption, settings, options.samples), options.folder / caption.replace(" ", "_")
        )
    save_page(seen, COLUMNS, options.folder / "lights.png")


if __name__ == "__main__":
    main()
