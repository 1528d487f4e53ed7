"""A page about a comparison: the conclusion, the images that differ beside each other, and the tables as curves."""

from collections.abc import Sequence
from dataclasses import dataclass

from symolo.compare.comparison import Comparison
from symolo.compare.conclusion import Conclusion
from symolo.compare.folders import FileResult, Verdict
from symolo.compare.likeness import shown_db
from symolo.compare.pairs import ColumnPair, ImagePair, column_pair, image_pair, is_image, is_table
from symolo.core.files.plain_files import FileKind, read_file
from symolo.pages.html import render_page

MAX_IMAGES, MAX_TABLES, MAX_LISTED = 60, 12, 1000
_TITLES = {
    Verdict.DIFFERENT: "Different files",
    Verdict.CLOSE: "Files that are equal within the tolerance",
    Verdict.ONLY_A: "Files only in A",
    Verdict.ONLY_B: "Files only in B",
    Verdict.FOLLOWS: "Lists and descriptions of the other files",
}
"""Title of the files of each verdict, in the order of the page."""


@dataclass(frozen=True)
class DifferingFile:
    """A file that differs, with what is shown of it."""

    name: str
    level: str
    what: str
    """Largest difference and its place; of a JSON file, up to five."""
    images: ImagePair | None = None
    column: ColumnPair | None = None


def comparison_page(comparison: Comparison) -> bytes:
    """Return the page, which needs no file beside itself; the same files give the same bytes."""
    unlike = comparison.unlike
    images = [_differing(comparison, result) for result in [one for one in unlike if is_image(one.name)][:MAX_IMAGES]]
    plotted = [_differing(comparison, result) for result in [one for one in unlike if is_table(one.name)][:MAX_TABLES]]
    conclusion = Conclusion.from_results(comparison.results)
    listed = {title: _listed(comparison.results, verdict) for verdict, title in _TITLES.items()}
    page = render_page(
        "symolo.compare",
        title=f"{comparison.a.name} and {comparison.b.name}: comparison",
        comparison=comparison,
        conclusion=conclusion.text,
        images=[one for one in images if one.images is not None],
        image_count=sum(is_image(result.name) for result in unlike),
        tables=[one for one in plotted if one.column is not None],
        listed={title: rows for title, rows in listed.items() if rows},
        setting_rows=[(one.field, one.a, one.b) for one in comparison.settings],
        max_listed=MAX_LISTED,
    )
    return page.encode()


def _listed(results: Sequence[FileResult], verdict: Verdict) -> list[tuple[str, str, str]]:
    rows = [result for result in results if result.verdict is verdict]
    with_level = verdict in {Verdict.DIFFERENT, Verdict.CLOSE}
    return [
        (result.name, shown_db(result.likeness.level_db) if with_level else "", result.likeness.what) for result in rows
    ]


def _differing(comparison: Comparison, result: FileResult) -> DifferingFile:
    places = [comparison.place(root, result.name) for root in (comparison.a, comparison.b)]
    try:
        one, other = (read_file(place, FileKind.ANY) for place in places)
    except OSError:  # its text is in the list of the files
        one = other = b""
    images = image_pair(one, other, result.name) if is_image(result.name) and one and other else None
    column = column_pair(one, other, result.name) if is_table(result.name) and one and other else None
    return DifferingFile(result.name, shown_db(result.likeness.level_db), result.likeness.what, images, column)
