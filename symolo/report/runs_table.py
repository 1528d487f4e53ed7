"""All runs in a table, and each in a sentence."""

from collections.abc import Iterator

from symolo.pages.markup import Html, table, tag
from symolo.report.statistics.facts import ReleaseFacts
from symolo.report.statistics.run_facts import RunFacts
from symolo.report.statistics.spread import spread

MAX_ROWS = 1000
_HEAD = ("run", "duration [s]", "lap [s]", "distance [m]", "rows", "images", "farthest off the line [mm]", "states")


def runs_table(facts: ReleaseFacts) -> Iterator[Html]:
    """A row for each run, linked where it is shown by itself."""
    shown = spread(facts.runs, MAX_ROWS)
    if len(shown) < len(facts.runs):
        yield tag("p", f"{len(shown)} of {len(facts.runs)} runs, spread evenly over them.", class_="note")
    yield table(_HEAD, [_row(one, linked=one.record.run in facts.detailed) for one in shown], class_="runs")
    told = "Farthest off the line: of the line sensor's middle from the line's, while the robot follows it (state 0)."
    yield tag("p", told, class_="note")


def _row(one: RunFacts, *, linked: bool) -> list[str]:
    record = one.record
    name = tag("a", record.run, href=f"#{anchor(record.run)}") if linked else record.run
    numbers = (
        f"{record.duration_s:.1f}",
        "-" if record.lap_time_s is None else f"{record.lap_time_s:.2f}",
        f"{record.distance_m:.2f}",
        str(record.rows),
        str(record.images),
        farthest(one),
    )
    order = " ".join(map(str, record.state_order[:20])) + (" ..." if len(record.state_order) > 20 else "")
    return [name, *(tag("td", number, class_="n") for number in numbers), order]


def farthest(one: RunFacts) -> str:
    return "-" if one.farthest_following_m is None else f"{1000 * one.farthest_following_m:.1f}"


def anchor(run: str) -> str:
    return f"run-{run}"


def of_one(one: RunFacts) -> str:
    """What stands above the picture of a run."""
    record = one.record
    lap = "" if record.lap_time_s is None else f" A lap takes {record.lap_time_s:.2f} s."
    never = "It never follows the line."
    following = f"While it follows the line it is {farthest(one)} mm off at most."
    told = f"{record.duration_s:.1f} s, {record.distance_m:.2f} m, {record.rows} rows, {record.images} images."
    return f"{told}{lap} {never if one.farthest_following_m is None else following}"
