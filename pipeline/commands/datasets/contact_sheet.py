"""`symolo contact-sheet`: puts images of every run on one sheet."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.options import Runs, Shown, checked_new_image


def contact_sheet(
    folder: Shown,
    *,
    out: Annotated[
        Path,
        typer.Option("--out", metavar="FILE", callback=checked_new_image, help="Image file to write, .jpg or .png."),
    ],
    per_run: Annotated[
        int, typer.Option(min=1, max=100, metavar="N", help="Number of images of each run, evenly spaced.")
    ] = 6,
    width_px: Annotated[int, typer.Option(min=16, max=4096, metavar="PX", help="Width of each image in pixels.")] = 240,
    camera: Annotated[
        str | None,
        typer.Option(
            metavar="NAME", help="Further camera of the robot to show, such as left; by default that of data.csv."
        ),
    ] = None,
    runs: Runs = None,
) -> None:
    """Put images of every run on one sheet, labelled with run, image number and state.

    Runs without images, such as those that are simulated only, show the floor with the robot and its path.

    Example: symolo contact-sheet data --out sheet.jpg
    """
    from pipeline.run_folder.shown_runs import failed_runs_note, shown_runs
    from symolo.core.progress import plural
    from symolo.pages.sheet import save
    from symolo.playback.from_run import has_specification
    from symolo.report.contact_sheet import contact_sheet as sheet_of

    with shown_runs(folder, runs) as data:
        sheet = sheet_of(data, per_run, width_px, camera or "")
        save(sheet, out)
        count, note = plural(len(data), "run"), failed_runs_note(data)
        further = dict.fromkeys(name for run in data if has_specification(run) for name in run.cameras)
    typer.echo(f"{out}: {count}, {sheet.shape[1]} x {sheet.shape[0]} px")
    if further and camera is None:
        typer.echo(f"not shown: the cameras {', '.join(further)}; see one of them with --camera NAME")
    if note:
        typer.echo(note)
