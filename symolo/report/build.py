"""The page of a release, from its folder alone: the same bytes for the same release."""

from collections.abc import Iterator, Sequence

from symolo.core.progress import Report
from symolo.reader.dataset import Dataset
from symolo.report.page import MAX_OUTLIERS, page
from symolo.report.plots.all_plots import A_FIGURE, Pictures
from symolo.report.state_sheets import shown_of_states, thumbnail
from symolo.report.statistics.facts import ReleaseFacts, release_facts
from symolo.report.statistics.maps import Map, maps_of
from symolo.report.statistics.spread import spread

MAX_MAPS = 12
"""Whole figures of them."""
MAX_ROWS = 40
"""Runs whose images' numbers have a row of their own."""


def release_report(data: Dataset, most_detailed: int, report: Report) -> bytes:
    """The page.

    Args:
        data: A release, or some of its runs, that is as it was released.
        most_detailed: So many runs at most are shown one by one.
        report: Where to tell.

    Raises:
        InputError: A file of the release is not what it should be.
    """
    if data.metadata is None:
        raise ValueError("a run alone has no metadata")
    facts = release_facts(data, data.metadata, most_detailed, report)
    return page(facts, _pictures(data, facts, report)).encode()


def _pictures(data: Dataset, facts: ReleaseFacts, report: Report) -> Pictures:
    # Matplotlib takes half a second to load, and is asked for only when the facts are sound.
    from symolo.report.plots.brightness import brightness_picture, spread_picture  # noqa: PLC0415
    from symolo.report.plots.map import map_picture  # noqa: PLC0415
    from symolo.report.plots.run import run_picture  # noqa: PLC0415

    of_run = {one.record.run: one for one in facts.runs}
    maps = maps_of(facts.runs)
    sheets = shown_of_states(facts.runs)
    rows = spread(facts.images, MAX_ROWS)
    runs = {}
    with report.stage("pictures", len(facts.detailed), "runs") as stage:
        for done, name in enumerate(facts.detailed, start=1):
            runs[name] = run_picture(data[name], of_run[name])
            stage.update("all", done)
    shown = {(one.run, one.number) for of_state in sheets.values() for one in of_state}
    shown |= {(one.run, one.worst) for one in facts.outliers[:MAX_OUTLIERS]}
    return Pictures(
        maps=tuple(map_picture(some) for some in _figures(spread(maps, MAX_MAPS))),
        maps_in_all=len(maps),
        runs=runs,
        sheets=sheets,
        images={(run, number): thumbnail(data, run, number) for run, number in sorted(shown)},
        brightness=brightness_picture(facts.images) if facts.images else b"",
        spread=spread_picture(rows) if rows else b"",
        spread_of=len(rows),
    )


def _figures(maps: Sequence[Map]) -> Iterator[tuple[Map, ...]]:
    return (tuple(maps[i : i + A_FIGURE]) for i in range(0, len(maps), A_FIGURE))
