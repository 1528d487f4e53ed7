"""`symolo view`: plays runs in a browser, or follows a release while it is made."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.options import Runs, Shown, if_given, new_file_check


def view(
    folder: Shown,
    *,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="FILE",
            callback=if_given(new_file_check(".html", option="--out")),
            help="Page to write, .html; by default it is named after the dataset, such as smoke-view.html.",
        ),
    ] = None,
    runs: Runs = None,
    max_runs: Annotated[
        int, typer.Option(min=1, max=200, metavar="N", help="Maximum number of runs on the page.")
    ] = 12,
    max_images: Annotated[
        int, typer.Option(min=1, max=100_000, metavar="N", help="Maximum number of images on the page.")
    ] = 1500,
    width_px: Annotated[
        int, typer.Option(min=16, max=4096, metavar="PX", help="Maximum width of the images on the page.")
    ] = 320,
    follow: Annotated[
        bool,
        typer.Option("--follow", help="Show a release while it is made: how far it is, the last image and its place."),
    ] = False,
    every_s: Annotated[
        float,
        typer.Option("--every-s", min=0.5, max=3600, metavar="S", help="Time between two versions of that page."),
    ] = 3.0,
) -> None:
    """Play runs in a browser: what the camera sees, the map with the robot, and the readings over time.

    The command writes one page with a slider over time, which needs no other files and no network, and opens it where
    there is a screen. Runs may be released, rendered again, or simulated only, even while they are being made. The same
    runs give the same bytes.

    Example: symolo view data --out view.html

    Only some runs, with larger images: symolo view data --runs "CW/*" --width-px 640

    In a second terminal, while a release is made: symolo view data --follow

    With --follow, the command writes the page again every few seconds, and the browser loads it again. The command ends
    when the release is finished.
    """
    if follow:
        _follow(folder, out, every_s)
        return
    from pipeline.run_folder.shown_runs import failed_runs_note, shown_runs
    from symolo.core.files.atomic_files import write_file
    from symolo.core.progress import plural, report_here
    from symolo.view.page import ViewLimits, view_page

    place = out or new_file_check(".html", option="--out")(Path(f"{folder.absolute().name}-view.html"))
    with shown_runs(folder, runs) as data:
        made = view_page(data, ViewLimits(max_runs, max_images, width_px), report_here())
        note = failed_runs_note(data)
    write_file(place, made.html)
    counts = f"{plural(made.runs, 'run')}, {plural(made.images, 'image')}"
    typer.echo(f"{place}: {counts}, {len(made.html) / 1e6:.1f} MB")
    if note:
        typer.echo(note)
    if out is None:
        _open_in_browser(place)


def _follow(folder: Path, out: Path | None, every_s: float) -> None:
    from pipeline.release_view.follow import follow

    place = out or new_file_check(".html", option="--out")(Path(f"{folder.absolute().name}-live.html"))

    def begun() -> None:
        typer.echo(f"{place}: the browser loads it again every {every_s:g} s, until the release is finished")
        if out is None:
            _open_in_browser(place)

    follow(folder, place, every_s, begun)
    typer.echo(f"{place}: the release is finished")


def _open_in_browser(page: Path) -> None:
    """Open a page where there is a screen; elsewhere, a browser for terminals would take over the terminal."""
    import os
    import sys
    import webbrowser

    if sys.platform != "linux" or os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"):
        webbrowser.open(page.absolute().as_uri())
