"""Commands that show data: view, video, report, contact-sheet."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.options import Dataset, Runs, checked_input, checked_new_image, if_given, new_file_check

Shown = Annotated[
    Path,
    typer.Argument(
        metavar="DIR",
        callback=checked_input,
        help="Dataset, run folder, output folder of simulate, or a data.csv.",
    ),
]


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


def video(
    folder: Shown,
    *,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="FILE",
            callback=if_given(new_file_check(".mp4", ".gif", ".webp")),
            help="Video to write, .mp4, .gif or .webp; by default it is named after the dataset, such as smoke.mp4.",
        ),
    ] = None,
    runs: Runs = None,
    max_runs: Annotated[int, typer.Option(min=1, max=1000, metavar="N", help="Maximum number of runs.")] = 12,
    speed: Annotated[
        float, typer.Option(min=0.05, max=100, metavar="N", help="Seconds of a run per second of the video.")
    ] = 1.0,
    fps: Annotated[
        float | None,
        typer.Option(min=0.5, max=60, metavar="HZ", help="Frames per second; by default 20 for .mp4, otherwise 10."),
    ] = None,
    width_px: Annotated[
        int | None,
        typer.Option(
            min=320, max=3840, metavar="PX", help="Width of the video; by default 1280 for .mp4, otherwise 640."
        ),
    ] = None,
) -> None:
    """Make a video of runs: what the camera sees, the floor with the robot, its state and its readings.

    The runs follow one after another. They may be released, rendered again, or simulated only; without images, the
    floor is larger. MP4 has H.264, which every browser plays, and needs the extra `video`. The same runs give the same
    bytes.

    Example: symolo video data --out run.mp4 --runs CW/test_1

    A small animation at four times the speed: symolo video data/CW/test_1 --out run.gif --speed 4
    """
    from fractions import Fraction

    from pipeline.run_folder.shown_runs import failed_runs_note, shown_runs
    from symolo.core.files.atomic_files import remove_left_of, write_chunks
    from symolo.core.progress import plural, report_here, seconds
    from symolo.video.build import Video, VideoSettings
    from symolo.video.encoders import FORMATS, check_encoder

    place = out or new_file_check(".mp4")(Path(f"{folder.absolute().name}.mp4"))
    kind = FORMATS[place.suffix]
    check_encoder(place)
    remove_left_of(place)
    rate = Fraction(fps or kind.fps).limit_denominator(1000)
    settings = VideoSettings(width_px or kind.width_px, rate, speed, max_runs)
    with shown_runs(folder, runs) as data:
        made = Video(data, settings)
        note = failed_runs_note(data)
        made.check_length(kind.max_frames)
        with report_here().stage("video", made.film().count, "frames") as stage:
            write_chunks(place, kind.chunks(made.film(stage)))
    left_out = f" of {len(data)}" if made.runs < len(data) else ""
    size = f"{place.stat().st_size / 1e6:.1f} MB"
    typer.echo(
        f"{place}: {made.runs}{left_out} {plural(made.runs, 'run').split()[1]}, {seconds(made.duration_s)}, {size}"
    )
    if note:
        typer.echo(note)


def report(
    folder: Dataset,
    *,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="FILE",
            callback=if_given(new_file_check(".html")),
            help="Page to write, .html; by default it is named after the dataset, such as smoke-report.html.",
        ),
    ] = None,
    runs: Runs = None,
    detail: Annotated[
        int,
        typer.Option(min=0, max=200, metavar="N", help="Maximum number of runs that have their own section."),
    ] = 12,
) -> None:
    """Make one HTML page about a release: images, paths, runs, random draws, warnings, provenance.

    The page is one file that needs no other files and no network. The release is checked first, and a damaged release
    is refused. The same release gives the same bytes. Runs that are simulated and not released yet have a page too.

    Example: symolo report data --out report.html
    """
    from pipeline.run_folder.shown_runs import checked_runs
    from symolo.core.files.atomic_files import write_file
    from symolo.core.progress import plural, report_here
    from symolo.report.build import release_report

    place = out or new_file_check(".html")(Path(f"{folder.absolute().name}-report.html"))
    with checked_runs(folder, runs) as data:
        page = release_report(data, detail, report_here())
        count = plural(len(data), "run")
    write_file(place, page)
    typer.echo(f"{place}: {count}, {len(page) / 1e6:.1f} MB")


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
