"""`symolo compare`: compares two datasets, runs or folders of images."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.options import (
    Json,
    checked_input,
    if_given,
    new_file_check,
)


def compare(
    a: Annotated[
        Path, typer.Argument(metavar="A", callback=checked_input, help="Dataset, run, folder of images, or a file.")
    ],
    b: Annotated[
        Path,
        typer.Argument(metavar="B", callback=checked_input, help="The same kind of data, to be compared with A."),
    ],
    tolerance_db: Annotated[
        float,
        typer.Option(
            "--tolerance-db",
            min=0,
            max=1000,
            metavar="DB",
            help="Smallest peak signal-to-noise ratio of files that count as equal; the peak of a column of numbers is "
            "its largest value.",
        ),
    ] = 50.0,
    *,
    every: Annotated[bool, typer.Option("--all", help="Also list identical files.")] = False,
    page: Annotated[
        Path | None,
        typer.Option(
            "--page",
            metavar="FILE",
            callback=if_given(new_file_check(".html", option="--page")),
            help="Also write a page with the images that differ beside each other, .html.",
        ),
    ] = None,
    as_json: Json = False,
) -> int:
    """Compare two datasets, runs or folders of images, file by file.

    The command prints a line for each file whose bytes differ, for each program and processor that differs, and for
    each setting of two releases that differs, and a line with the conclusion. The exit code is 0 if all files are
    identical, 6 if they are equal within --tolerance-db, and 7 if they differ.

    Example: symolo compare data data-of-another-machine --tolerance-db 60

    Example: symolo compare before after --page differences.html
    """
    from symolo.compare.comparison import Comparison
    from symolo.compare.conclusion import Conclusion, made_differently
    from symolo.compare.folders import Verdict
    from symolo.compare.folders import compare as results_of
    from symolo.compare.settings import changed_settings

    results = []
    for result in results_of(a, b, tolerance_db):
        results.append(result)
        if not as_json and (every or result.verdict is not Verdict.IDENTICAL):
            typer.echo(str(result))
    comparison = Comparison(a, b, tolerance_db, results, list(made_differently(a, b)), changed_settings(a, b))
    if page is not None:
        from symolo.compare.page import comparison_page
        from symolo.core.files.atomic_files import write_file

        write_file(page, comparison_page(comparison))
    if as_json:
        from pipeline.json_results.compare import CompareResult

        compared = CompareResult.from_comparison(comparison, every=every)
        typer.echo(compared.to_json())
        return compared.exit_code
    conclusion = Conclusion.from_results(results)
    typer.echo("\n".join((*comparison.other_lines, conclusion.text)))
    return conclusion.code
