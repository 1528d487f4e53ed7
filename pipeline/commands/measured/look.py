"""Commands for looks: `symolo look from`."""

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pipeline.commands.options import DryRun, NewFolder, Workers, checked_inputs, read_input
from symolo.core.errors import FaultList, InputError, nearest
from symolo.core.files.plain_files import FileKind

if TYPE_CHECKING:
    from configs.schema.appearance.floors import FloorName

HELP = "Make a look, with floor, line, light and camera, from photographs of your own."


def from_(
    photographs: Annotated[
        list[Path],
        typer.Argument(
            metavar="PHOTO...", callback=checked_inputs, help="3 to 30 photographs of one size, as PNG or JPEG."
        ),
    ],
    *,
    out: NewFolder,
    base: Annotated[
        str,
        typer.Option(
            "--base",
            metavar="LOOK",
            help="Look with all settings that photographs do not show, such as the room and the noise reduction of "
            "the camera: name of a shipped one, or a YAML file.",
        ),
    ] = "lab",
    floor: Annotated[
        str,
        typer.Option(
            "--floor",
            metavar="MATERIAL",
            help="Floor: `photographs` makes an image with the texture of the photographs; or a material, such as "
            "linoleum or carpet, of which only the amount of texture is fitted.",
        ),
    ] = "photographs",
    floor_reflectance: Annotated[
        float | None,
        typer.Option(
            "--floor-reflectance",
            min=0.02,
            max=0.95,
            metavar="R",
            help="Share of the light that the floor reflects; by default 0.45, or less where the line is lighter than "
            "the floor. Photographs show only the ratio of line and floor.",
        ),
    ] = None,
    width_px: Annotated[
        int | None,
        typer.Option(
            "--width-px",
            min=64,
            max=4096,
            metavar="PX",
            help="Width to which the photographs are reduced: that of the images of your dataset. By default they keep "
            "their size, up to 640 px.",
        ),
    ] = None,
    render: Annotated[
        bool,
        typer.Option(
            "--render/--no-render",
            help="Whether to correct the look by rendered images. For seven photographs of 160 x 120 px, the command "
            "took 143 s on two shared cores, and 10 s without rendering.",
        ),
    ] = True,
    line_width_mm: Annotated[
        float,
        typer.Option(
            "--line-width-mm",
            min=4,
            max=100,
            metavar="MM",
            help="Width of the line on the floor, measured with a ruler.",
        ),
    ] = 15.0,
    pitch_down_deg: Annotated[
        float,
        typer.Option(
            "--pitch-down-deg",
            min=20,
            max=90,
            metavar="DEG",
            help="Angle of the camera below the horizon; 90 looks straight down.",
        ),
    ] = 90.0,
    field_of_view_deg: Annotated[
        float,
        typer.Option(
            "--field-of-view-deg",
            min=10,
            max=150,
            metavar="DEG",
            help="Angle between the left and the right border of the photographs; the data sheet of the camera has it. "
            "Raspberry Pi camera v1: 53.5, v2: 62.2.",
        ),
    ] = 60.0,
    workers: Workers = None,
    dry_run: DryRun = False,
) -> None:
    """Make a look from photographs of your own floor, line and camera; no poses are needed.

    Take the photographs with the camera of the robot, from where it drives. The line must cross the image, with floor
    on both sides; it may be dark or light. Different places of the floor are best.

    The command finds the line in each photograph and measures the width of its edge, the noise on floor and line, the
    fall of the light towards the corners, its rise to the right and downwards, levels and colours, the texture of the
    floor, and sheets of paper along the line. It then looks for the settings with which the camera model makes an image
    with the same measures: blur, sharpening, shot and read noise, vignetting, shading, exposure, and the colours of
    floor and line.

    Then it renders 8 to 12 small images with lines as in the photographs, measures them in the same way, and corrects
    the settings, with the texture of floor and line, three times. This takes minutes; --no-render leaves it out.

    Photographs do not show how large things are. --line-width-mm and --field-of-view-deg give the scale: from them
    follow the height of the camera above the floor and the size of the texture.

    Files in OUT:

    - look.yaml: the look; comments say what set each value, and how much it varies over the photographs

    - floor.png: the floor, made of the texture of the photographs; it repeats without a seam

    - scenario.yaml: the look, the width of the line, and a camera that sees it as the photographs do

    - report.html: the photographs, the figures and the settings

    Example: symolo look from photos/*.jpg --line-width-mm 19 --field-of-view-deg 53.5 --out my_look

    In seconds, without rendering: symolo look from photos/*.jpg --no-render --out my_look

    Then: symolo release my_look/scenario.yaml --out data

    docs/own_look.md explains what photographs can tell, and what they cannot.
    """
    from diagnosis.photographs.report import table_lines
    from pipeline.look_from_photographs.fit import LOOK, PAGE, SCENARIO_FILE, base_camera, fit_look, write_look
    from pipeline.look_from_photographs.photographs import read_photographs
    from pipeline.look_from_photographs.refine import RenderSettings, refined
    from pipeline.look_from_photographs.scenario import camera_height_m, shadow_warning
    from pipeline.look_from_photographs.views import ViewGeometry
    from pipeline.work.supervisor import cores
    from symolo.core.files.new_folder import check_new
    from symolo.core.progress import report_here

    material = _material(floor)
    if not dry_run:
        check_new(out)
    base_camera(base, keeps_files=material is not None)
    read = read_photographs(_files(photographs), width_px)
    for note in read.notes:
        typer.echo(note)
    geometry = ViewGeometry(0.001 * line_width_mm, pitch_down_deg, field_of_view_deg)
    look = fit_look(read, out, base, floor=material, floor_reflectance=floor_reflectance, geometry=geometry)
    camera_height_m(look, geometry)
    if render and not dry_run:
        look = refined(look, RenderSettings(geometry, workers or cores()), report_here())
    for doubt in (*look.doubts, shadow_warning(look, geometry)):
        typer.echo(f"warning: {doubt}")
    for line in table_lines(look):
        typer.echo(line)
    if dry_run:
        typer.echo(look.text(out.absolute()))
        return
    write_look(look, read, out, geometry)
    written = (LOOK, *look.files, SCENARIO_FILE, PAGE)
    typer.echo(f"\n{', '.join(str(out / name) for name in written)}\n")
    typer.echo(f"symolo release {shlex.quote(str(out / SCENARIO_FILE))} --out data")
    typer.echo(f"With a scenario of your own: {look.settings_to_use(str(out / LOOK))}")


def _material(floor: str) -> "FloorName | None":
    """Return the material of `--floor`, or None for the texture of the photographs."""
    from diagnosis.photographs.fitted_look import PAINTED_FLOORS

    if floor in PAINTED_FLOORS:
        return floor
    if floor != "photographs":
        allowed = "photographs", *PAINTED_FLOORS
        raise InputError("--floor", got=floor, allowed=", ".join(allowed), nearest=nearest(floor, allowed))
    return None


def _files(photographs: Sequence[Path]) -> list[tuple[Path, bytes]]:
    """Return the photographs with their bytes; all that cannot be read are reported together."""
    faults, files = FaultList(), list[tuple[Path, bytes]]()
    for path in photographs:
        with faults.noted():
            files.append((path, read_input(path, FileKind.IMAGE)))
    faults.check()
    return files


COMMANDS = (from_,)
