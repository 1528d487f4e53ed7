"""The look of photographs, and its files."""

import json
import re
from collections.abc import Mapping
from pathlib import Path

from configs.draw import draw_run
from configs.loader import load_scenario, load_section
from configs.schema.appearance.camera_look import CameraLook
from configs.schema.appearance.floors import FloorName
from diagnosis.photographs.camera_fit import fit_camera
from diagnosis.photographs.fitted_look import FittedLook, floor_reflectance_for
from diagnosis.photographs.report import report_page
from pipeline.own_look.photographs import LookPhotographs
from symolo.core.files.atomic_files import write_file
from symolo.core.files.new_folder import new_folder

LOOK, PAGE = "look.yaml", "report.html"
_SCENARIO = "smoke"
"""Scenario that draws the settings of the base look; its arena and robot do not matter."""


def fit_look(
    read: LookPhotographs, out: Path, base: str, floor: FloorName, floor_reflectance: float | None
) -> FittedLook:
    """Return the look of photographs.

    Args:
        read: The photographs.
        out: Folder of the files; the look is named after it.
        base: Look that has all settings which photographs do not show.
        floor: Material of the floor.
        floor_reflectance: Reflectance of the floor; None for the usual one.

    Raises:
        InputError: There is no look `base`, or a setting of it is wrong.
    """
    camera = fit_camera(read.measured, base_camera(base))
    return FittedLook(
        name=re.sub(r"[^A-Za-z0-9_-]+", "_", out.absolute().name).strip("_-")[:64] or "my_look",
        base=base,
        photographs=read.measured,
        camera=camera,
        floor=floor,
        floor_reflectance=floor_reflectance_for(camera) if floor_reflectance is None else floor_reflectance,
        reflectance_is_assumed=floor_reflectance is None,
    )


def base_camera(base: str) -> CameraLook:
    """Return the camera of the base look; of settings that are distributions, one draw.

    Raises:
        InputError: There is no such look, or a setting of it is wrong.
    """
    load_section("look", base, option="--base")
    loaded = load_scenario(_SCENARIO, (f"look={json.dumps(base)}",))
    return draw_run(loaded, loaded.routes[0].name, 1).look.camera


def look_files(look: FittedLook, read: LookPhotographs, out: Path) -> Mapping[str, bytes]:
    """Return the contents of the files of the folder `out` by name; the same bytes for the same look."""
    return {LOOK: look.text(out).encode(), PAGE: report_page(look, (*read.notes, *look.doubts)).encode()}


def write_look(look: FittedLook, read: LookPhotographs, out: Path) -> None:
    """Write the files of a look into a new folder, and check that the look can be loaded."""
    with new_folder(out) as partial:
        for name, data in look_files(look, read, out.absolute()).items():
            write_file(partial / name, data)
        load_section("look", str(partial / LOOK))
