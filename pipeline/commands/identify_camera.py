"""The command `symolo identify-camera`: what differs in a real camera, by its images."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.options import Out, checked_input


def _checked(path: Path | None) -> Path | None:
    return None if path is None else checked_input(path)


def identify_camera(
    run: Annotated[
        Path,
        typer.Argument(metavar="RUN", callback=checked_input, help="Folder with data.csv and the measured images."),
    ],
    *,
    out: Out,
    simulated: Annotated[
        Path | None,
        typer.Option(
            metavar="RUN",
            callback=_checked,
            help="Run of a dataset with the nominal camera, look and arena, and images of the same places.",
        ),
    ] = None,
    pose_sd_mm: Annotated[
        float, typer.Option("--pose-sd-mm", min=0.01, max=100, metavar="MM", help="Error of the poses' places.")
    ] = 0.5,
    pose_sd_deg: Annotated[
        float, typer.Option("--pose-sd-deg", min=0.001, max=20, metavar="DEG", help="Error of the poses' headings.")
    ] = 0.1,
    as_json: Annotated[bool, typer.Option("--json", help="Print the answer as JSON, and nothing else.")] = False,
) -> None:
    """Identify what differs in a real camera: its place, its lens, its exposure.

    Compares the edges of the line in the images with where the nominal camera
    would see them from the poses of data.csv, and floor and edges with
    simulated images of the same places. It names what differs, with value and
    standard error. Every fourth image is held out of the fit and shows what
    the new camera gains. See docs/camera_identification.md.

    Writes into DIR: report.html, answer.json, summary.txt, plots/, and
    robot.yaml and look.yaml with the identified camera.

    Example: symolo identify-camera measured/run_1 --simulated data/CW/test_1 --out camera
    """
    import json

    from diagnosis.camera.case import PoseErrors
    from diagnosis.camera.diagnose import diagnose_camera
    from diagnosis.camera.files import files
    from diagnosis.report.files import PAGE, SUMMARY
    from pipeline.diagnosing.camera_case import read_camera_case
    from pipeline.run_folder.output import check_out
    from pipeline.run_folder.workspace import Workspace
    from symolo.core.files.atomic_files import make_folder, remove_file, write_file
    from symolo.dataset.folder_kind import Kind

    case = read_camera_case(run, simulated, PoseErrors(0.001 * pose_sd_mm, pose_sd_deg))
    check_out(out, Kind.CAMERA_IDENTIFICATION)
    diagnosis = diagnose_camera(case)
    made = files(diagnosis)
    with Workspace(out.absolute(), Kind.CAMERA_IDENTIFICATION).locked():
        for name in sorted(OPTIONAL - made.keys()):
            remove_file(out / name)
        for name, data in made.items():
            make_folder((out / name).parent)
            write_file(out / name, data)
    if as_json:
        typer.echo(json.dumps(diagnosis.answer(), indent=2))
        return
    typer.echo(made[SUMMARY].decode())
    typer.echo(str(out / PAGE))


OPTIONAL = {"robot.yaml", "look.yaml"}
"""Files that an earlier diagnosis may have left and this one may not write."""
