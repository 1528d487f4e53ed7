"""A dataset held against a measured drive, on a terminal and on the page."""

from collections.abc import Iterator

import numpy as np

from diagnosis.against import Against, Compared, Left
from diagnosis.report.quantities import axis, percent
from symolo.pages.markup import Html, picture, table, tag

MAX_RUNS = 12
"""In the table of runs."""


def verdict(found: Against) -> list[str]:
    """A sentence for what is covered, and one for each quantity that is not."""
    count = len(found.runs)
    runs = "its run" if count == 1 else f"its {count} runs"
    beyond = [_beyond(of) for of in found.left if not of.is_covered]
    beyond += [_louder(of) for of in found.left if not of.scatters_alike]
    beyond += [_outside(of) for of in found.seen if not of.is_covered]
    if not beyond:
        return [f"The dataset {found.release} covers the measured drive: nothing of it lies outside of {runs}."]
    return [f"The dataset {found.release} does not cover the measured drive, by {runs}:", *beyond]


def _beyond(of: Left) -> str:
    low, high = min(of.middles), max(of.middles)
    return (
        f"{of.name} is {_signed(of.middle)} {of.unit} off the textbook robot's, that of the runs "
        f"{_signed(low)} to {_signed(high)} {of.unit}: no robot of the dataset is like this one."
    )


def _louder(of: Left) -> str:
    low, high = min(of.scatters), max(of.scatters)
    return (
        f"{of.name} scatters by {of.scatter:.2g} {of.unit} about it, that of the runs by {_range(low, high)} {of.unit}."
    )


def _range(low: float, high: float) -> str:
    first, last = f"{low:.2g}", f"{high:.2g}"
    return first if first == last else f"{first} to {last}"


def _outside(of: Compared) -> str:
    low, high = of.pooled.min(), of.pooled.max()
    return f"{percent(of.outside)} of {of.name} lie outside of the dataset's {low:.3g} to {high:.3g} {of.unit}."


def on_page(found: Against, picture_of_it: bytes) -> Iterator[Html]:
    """Verdict, distributions, and a table of runs."""
    first, *rest = verdict(found)
    yield tag("p", first, class_="glance")
    if rest:
        yield tag("ul", [tag("li", text) for text in rest])
    caption = "Share of samples below a value: the measured drive, each run of the dataset, and all of them."
    yield tag("figure", picture(picture_of_it, caption), tag("figcaption", caption))
    rows = [[axis(of.name), *_quantiles(of), percent(of.outside), f"{of.apart:.2f}"] for of in found.seen]
    yield table(["what is seen", "measured", "dataset", "outside of it", "apart, 0 to 1"], rows)
    told = (
        "Median, and from where to where nine samples of ten lie. Apart: the largest distance of the two curves above."
    )
    yield tag("p", told, class_="note")
    if found.left:
        yield tag("h3", "What the textbook robot leaves")
        yield table(["run", *(f"{of.name} [{of.unit}]" for of in found.left)], _runs(found))
        told = (
            "Median of measured less predicted, each stage driven by what was logged at its input, and the scatter "
            "about it. A dataset covers a robot whose medians lie among those of its runs."
        )
        yield tag("p", told, class_="note")


def _quantiles(of: Compared) -> list[str]:
    found = []
    for values in (of.measured, of.pooled):
        low, middle, high = np.quantile(values, [0.05, 0.5, 0.95]).tolist()
        found.append(f"{middle:.3g} ({low:.3g} to {high:.3g})")
    return found


def _runs(found: Against) -> Iterator[list[str | Html]]:
    yield ["measured", *(f"{_signed(of.middle)} ± {of.scatter:.2g}" for of in found.left)]
    shown = list(range(len(found.left[0].runs)))[:MAX_RUNS]
    for k in shown:
        name = found.runs[k] if len(found.runs) == len(found.left[0].runs) else f"run {k + 1}"
        yield [name, *(f"{_signed(of.middles[k])} ± {of.scatters[k]:.2g}" for of in found.left)]
    more = len(found.left[0].runs) - len(shown)
    if more > 0:
        ends = (f"{_signed(min(of.middles))} to {_signed(max(of.middles))}" for of in found.left)
        yield [f"all, with {more} more", *ends]


def _signed(value: float) -> str:
    return f"{value:+.2g}"


def in_json(found: Against) -> dict[str, object]:
    """For answer.json."""
    return {
        "release": found.release,
        "runs": len(found.runs),
        "seen": {
            of.name: {"unit": of.unit, "outside": of.outside, "apart": of.apart, "covered": of.is_covered}
            for of in found.seen
        },
        "left": {
            of.name: {
                "unit": of.unit,
                "middle": of.middle,
                "middles": [min(of.middles), max(of.middles)],
                "scatter": of.scatter,
                "scatters": [min(of.scatters), max(of.scatters)],
                "covered": of.is_covered,
            }
            for of in found.left
        },
    }
