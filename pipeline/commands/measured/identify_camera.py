"""`symolo identify-camera`: estimates the settings of a camera from its images."""

import json
from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.options import Json, Out, checked_input, if_given

OPTIONAL = {"robot.yaml", "look.yaml"}
"""Files that an earlier diagnosis may have left and this one may not write."""


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
            callback=if_given(checked_input),
            help="Run of a dataset with the nominal camera, look and arena, and images of the same places.",
        ),
    ] = None,
    pose_sd_mm: Annotated[
        float,
        typer.Option(
            "--pose-sd-mm", min=0.01, max=100, metavar="MM", help="Standard deviation of the positions in data.csv."
        ),
    ] = 0.5,
    pose_sd_deg: Annotated[
        float,
        typer.Option(
            "--pose-sd-deg", min=0.001, max=20, metavar="DEG", help="Standard deviation of the headings in data.csv."
        ),
    ] = 0.1,
    as_json: Json = False,
) -> None:
    """Identify how a real camera differs from the nominal one: position, lens, exposure.

    The command compares the edges of the line in the images with the edges
    that the nominal camera would see from the poses of data.csv. With
    --simulated it also compares floor and edges with simulated images of the
    same places. The result names each difference with its value and standard
    error. Every fourth image is not used for the fit. These images show how much
    better the identified camera predicts than the nominal one. See
    docs/camera_identification.md.

    Files in DIR: report.html, answer.json, summary.txt, plots/, and robot.yaml
    and look.yaml with the identified camera.

    Example: symolo identify-camera measured/run_1 --simulated data/CW/test_1 --out camera
    """
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
