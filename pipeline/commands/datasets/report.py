"""`symolo report`: makes one HTML page about a release."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.options import Dataset, Runs, if_given, new_file_check


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
