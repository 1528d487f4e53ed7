"""The look of photographs, and its files."""

import json
import re
from dataclasses import replace
from pathlib import Path

from configs.draw import draw_run
from configs.loader import load_scenario, load_section
from configs.schema.appearance.camera_look import CameraLook
from configs.schema.appearance.floors import FloorName
from diagnosis.photographs.camera_fit import FittedCamera, fit_camera
from diagnosis.photographs.fitted_look import FittedLook, floor_reflectance_for
from diagnosis.photographs.floor_measures import FloorMeasures
from diagnosis.photographs.measured_floor import MeasuredFloor
from diagnosis.photographs.measures import median_of
from diagnosis.photographs.report import report_page
from pipeline.look_from_photographs.photographs import LookPhotographs
from pipeline.look_from_photographs.scenario import scenario_text
from pipeline.look_from_photographs.views import ViewGeometry
from symolo.core.errors import InputError
from symolo.core.files.atomic_files import write_file
from symolo.core.files.new_folder import new_folder

LOOK, SCENARIO_FILE, PAGE = "look.yaml", "scenario.yaml", "report.html"
_SCENARIO = "smoke"
"""Scenario that draws the settings of the base look; its arena and robot do not matter."""


def fit_look(
    read: LookPhotographs,
    out: Path,
    base: str,
    *,
    floor: FloorName | None,
    floor_reflectance: float | None,
    geometry: ViewGeometry,
) -> FittedLook:
    """Return the look of photographs.

    Args:
        read: The photographs.
        out: Folder of the files; the look is named after it.
        base: Look that has all settings which photographs do not show.
        floor: Material of the floor; None for the texture of the photographs.
        floor_reflectance: Reflectance of the floor; None for the usual one.
        geometry: View of the photographs, which decides how large the texture is.

    Raises:
        InputError: There is no look `base`, a setting of it is wrong, it has files that cannot be kept, or too little
            of the floor is visible.
    """
    base_look = base_camera(base, keeps_files=floor is not None)
    read = replace(read, measured=tuple(each.with_light_edges(base_look.contrast) for each in read.measured))
    camera = fit_camera(read.measured, base_look)
    return FittedLook(
        name=re.sub(r"[^A-Za-z0-9_-]+", "_", out.absolute().name).strip("_-")[:64] or "my_look",
        base=base,
        photographs=read.measured,
        camera=camera,
        floor=_measured_floor(read, camera, geometry) if floor is None else floor,
        floor_reflectance=floor_reflectance_for(camera) if floor_reflectance is None else floor_reflectance,
        reflectance_is_assumed=floor_reflectance is None,
        folder=read.folder,
    )


def _measured_floor(read: LookPhotographs, camera: FittedCamera, geometry: ViewGeometry) -> MeasuredFloor:
    angles = geometry.pitch_down_deg, geometry.field_of_view_deg
    try:
        measures = FloorMeasures.from_photographs(read.measured, camera.look, *angles)
    except ValueError as error:
        cure = "photograph more of the floor beside the line, or choose a material such as --floor concrete"
        raise InputError(str(error), where="PHOTO...", cure=cure) from error
    m_per_px = median_of(read.measured, lambda p: geometry.m_per_px(p.place))
    width_px, _ = read.measured[0].place.upright_size_px
    return MeasuredFloor(measures, geometry.line_width_m, m_per_px, width_px, angles)


def base_camera(base: str, *, keeps_files: bool = True) -> CameraLook:
    """Return the camera of the base look; of settings that are distributions, one draw.

    Args:
        base: Name of a look, or a path.
        keeps_files: Whether images and panoramas of the base look can be used.

    Raises:
        InputError: There is no such look, a setting of it is wrong, or it has files that cannot be used.
    """
    load_section("look", base, option="--base")
    loaded = load_scenario(_SCENARIO, (f"look={json.dumps(base)}",))
    if loaded.assets and not keeps_files:
        problem = "has images or a panorama of its own, beside which there can be no image of the floor"
        raise InputError(problem, where=f"--base {base}", cure="choose a material, such as --floor concrete")
    return draw_run(loaded, loaded.routes[0].name, 1).look.camera


def write_look(look: FittedLook, read: LookPhotographs, out: Path, geometry: ViewGeometry) -> None:
    """Write the files of a look into a new folder, and check that its scenario can be loaded."""
    with new_folder(out) as partial:
        for name, data in look.files.items():
            write_file(partial / name, data)
        write_file(partial / LOOK, look.text(out.absolute()).encode())
        write_file(partial / SCENARIO_FILE, scenario_text(look, LOOK, geometry).encode())
        write_file(partial / PAGE, report_page(look, (*read.notes, *look.doubts)).encode())
        load_scenario(str(partial / SCENARIO_FILE))
