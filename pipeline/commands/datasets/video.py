"""`symolo video`: makes a video of runs."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.options import Runs, Shown, if_given, new_file_check


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
