"""The page: what a release holds, what it looks like, what varies in it, and what made it."""

from collections.abc import Iterator

from symolo.pages.markup import Html, picture, tag
from symolo.pages.style import STYLE
from symolo.report.contents import contents, glance
from symolo.report.draws_table import draws_section
from symolo.report.page_style import STYLE as OWN_STYLE
from symolo.report.plots.all_plots import A_FIGURE, Pictures
from symolo.report.plots.states import named
from symolo.report.provenance import provenance, warnings
from symolo.report.runs_table import anchor, of_one, runs_table
from symolo.report.statistics.facts import ReleaseFacts
from symolo.report.statistics.outliers import Outlier

MAX_OUTLIERS = 12
"""Places whose farthest image is shown."""
_MAX_NAMED = 200
SVG = "image/svg+xml"


def page(facts: ReleaseFacts, pictures: Pictures) -> str:
    """The whole page, which needs nothing beside itself."""
    metadata = facts.metadata
    sections = {
        "contents": ("What is in it", contents(facts)),
        "map": ("Where the robot drove", _map(facts, pictures)),
        "runs": ("Runs", _runs(facts, pictures)),
        "states": ("Images of each state", _sheets(pictures)),
        "draws": ("What varies from run to run", draws_section(facts)),
        "images": ("Images in numbers", _images(facts, pictures)),
        "warnings": ("Warnings", warnings(metadata)),
        "provenance": ("Provenance", provenance(facts)),
    }
    body = [
        tag("h1", metadata.name),
        tag("p", metadata.description or "A synthetic dataset in the layout of SyMoLo.", class_="verdict"),
        tag("p", glance(facts), class_="glance"),
        tag("nav", [tag("a", title, href=f"#{name}") for name, (title, _) in sections.items()]),
    ]
    for name, (title, content) in sections.items():
        body += [tag("h2", title, id=name), *content]
    head = tag(
        "head",
        tag("meta", charset="utf-8"),
        tag("meta", name="viewport", content="width=device-width, initial-scale=1"),
        tag("title", f"{metadata.name}: release"),
        tag("style", Html(STYLE + OWN_STYLE)),
    )
    return f"<!DOCTYPE html>\n{tag('html', head, tag('body', body), lang='en')}\n"


def _map(facts: ReleaseFacts, pictures: Pictures) -> Iterator[Html]:
    tracks = sum(one.track is not None for one in facts.runs)
    told = "The middle of the axle, from the floor's frame W. Numbers on the first run of each map are states."
    if tracks < len(facts.runs):
        told += f" {tracks} of {len(facts.runs)} runs are drawn, spread evenly over them."
    if len(pictures.maps) * A_FIGURE < pictures.maps_in_all:
        told += f" {len(pictures.maps) * A_FIGURE} of {pictures.maps_in_all} maps are shown."
    figures = [tag("figure", picture(one, "Paths of the runs over the arena, by state", SVG)) for one in pictures.maps]
    yield _whole(tag("p", told, class_="note"), *figures[:1])
    yield from figures[1:]


def _whole(*content: Html) -> Html:
    """What is on one page of a print."""
    return tag("div", content, class_="whole")


def _runs(facts: ReleaseFacts, pictures: Pictures) -> Iterator[Html]:
    yield from runs_table(facts)
    told = (
        "Each run against time. Dotted verticals: another state. Ranges have gaps where a sensor saw no target. Line "
        "sensor: black is 0, white 1. Off the line: the middle of the sensor's row from the middle of the line, in the "
        "colour of the state, linear up to 1 mm and logarithmic above; grey is the line's own width, the triangle the "
        "farthest place."
    )
    if len(pictures.runs) < len(facts.runs):
        told = f"{len(pictures.runs)} of {len(facts.runs)} runs are shown, spread evenly over them. {told}"
    yield tag("p", told, class_="note")
    by_name = {one.record.run: one for one in facts.runs}
    for name, svg in pictures.runs.items():
        seen = picture(svg, f"{name} against time: states, speeds, ranges, line, distance from it", SVG)
        told = tag("p", of_one(by_name[name]))
        yield _whole(tag("h3", name, id=anchor(name)), told, tag("figure", seen))


def _sheets(pictures: Pictures) -> Iterator[Html]:
    if not pictures.sheets:
        yield tag("p", "There are no images.")
    for state, shown in pictures.sheets.items():
        sheet = _sheet([(one.run, one.number, f"{one.t_s:.1f} s") for one in shown], pictures)
        yield _whole(tag("h3", named(state)), sheet)


def _sheet(shown: list[tuple[str, int, str]], pictures: Pictures) -> Html:
    """Images by run and number, with a text below each."""
    cells = []
    for run, number, text in shown:
        seen = picture(pictures.images[run, number], f"{run}, image {number}", "image/jpeg")
        cells.append(tag("figure", seen, tag("figcaption", run, tag("br"), f"image {number}, {text}")))
    return tag("div", cells, class_="sheet")


def _images(facts: ReleaseFacts, pictures: Pictures) -> Iterator[Html]:
    if not facts.images:
        yield tag("p", "There are no images.")
        return
    told = "Grey values of all pixels. Up to the first dashed line a pixel is black, from the second on burnt."
    yield _whole(tag("p", told), tag("figure", picture(pictures.brightness, "Histogram of grey values", SVG)))
    told = "Each image by its mean, its clipped pixels and its sharpness: ends, middle half and median of each run."
    if pictures.spread_of < len(facts.images):
        told += f" {pictures.spread_of} of {len(facts.images)} runs are shown."
    figure = tag("figure", picture(pictures.spread, "Brightness, clipping and sharpness by run", SVG))
    yield _whole(tag("p", told), figure)
    yield tag("h3", "Unlike the others")
    found = facts.outliers
    if not found:
        yield tag(
            "p", "None: no image stands out in brightness or sharpness, and none is black or burnt in large parts."
        )
        return
    count, total = sum(len(one.numbers) for one in found), sum(len(of.numbers) for of in facts.images)
    shown = found[:MAX_OUTLIERS]
    places = f" in {len(found)} places, the farthest out first" if len(found) > 1 else ""
    more = f"; {len(shown)} of the places are shown" if len(shown) < len(found) else ""
    yield tag(
        "p", f"{count} of {total} images{places}{more}. That alone is no fault: a wall close by has little detail."
    )
    yield _sheet([(one.run, one.worst, f"{one.why}; {_alike(one)}") for one in shown], pictures)
    rest = found[MAX_OUTLIERS : MAX_OUTLIERS + _MAX_NAMED]
    if rest:
        names = [tag("li", f"{one.run}, image {one.worst}: {one.why}; {_alike(one)}") for one in rest]
        yield tag("details", tag("summary", f"{len(rest)} more"), tag("ul", names))


def _alike(one: Outlier) -> str:
    """Which images it stands for."""
    return "alone" if len(one.numbers) == 1 else f"so are {one.numbers[0]} to {one.numbers[-1]}"
