"""Whether names are right as often as the confidence reported with them says."""

from collections.abc import Sequence
from dataclasses import dataclass

from figures import interval
from matplotlib.figure import Figure
from score import Score

from symolo.pages.plotting import BLUE, GREY, finished

EDGES = (0.0, 0.5, 0.8, 0.9, 0.95, 0.99, 0.999)
"""Lower edges of the bins; the last one holds what the report calls over 99.9 % sure."""


@dataclass(frozen=True)
class Bin:
    """Names whose confidence is in one bin.

    Attributes:
        low: Lower edge.
        confidences: Confidence of each name.
        right: Number of names that were hidden.
        alike: Number that were hidden or that the data cannot tell from what was.
    """

    low: float
    confidences: tuple[float, ...]
    right: int
    alike: int

    @property
    def label(self) -> str:
        """Edges in percent."""
        above = [edge for edge in EDGES if edge > self.low]
        return f"{100 * self.low:g} to {100 * above[0]:g} %" if above else f"{100 * self.low:g} % and over"


def bins(scores: Sequence[Score]) -> list[Bin]:
    """Return the bins that hold a name."""
    names = [name for each in scores for name in zip(each.confidences, each.name_hits, each.name_alike, strict=True)]
    found = []
    for low, high in zip(EDGES, (*EDGES[1:], 2.0), strict=True):
        inside = [name for name in names if low <= name[0] < high]
        if inside:
            confidences, right, alike = zip(*inside, strict=True)
            found.append(Bin(low, confidences, sum(right), sum(alike)))
    return found


def reliability_table(scores: Sequence[Score]) -> list[str]:
    """Return lines to print: how many names of each confidence were right, with the 95 % interval after Wilson."""
    lines = [f"{'stated confidence':18s} {'names':>6s} {'mean':>7s} {'right':>6s} {'share':>24s}  right or alike"]
    for each in bins(scores):
        count = len(each.confidences)
        low, high = interval(each.right, count)
        share = f"{100 * each.right / count:.1f} % ({100 * low:.1f}-{100 * high:.1f})"
        mean = 100 * sum(each.confidences) / count
        lines.append(f"{each.label:18s} {count:6d} {mean:6.1f}% {each.right:6d} {share:>24s}  {each.alike}")
    return lines


def reliability_figure(scores: Sequence[Score], title: str) -> Figure:
    """Return the share of right names over the mean confidence of their bin, with Wilson intervals."""
    figure = Figure(figsize=(6.0, 4.4), layout="constrained")
    axes = figure.subplots()
    found = bins(scores)
    places = range(len(found))
    shares = [each.right / len(each.confidences) for each in found]
    limits = [interval(each.right, len(each.confidences)) for each in found]
    below = [max(share - low, 0.0) for share, (low, _) in zip(shares, limits, strict=True)]
    over = [max(high - share, 0.0) for share, (_, high) in zip(shares, limits, strict=True)]
    axes.errorbar(places, shares, (below, over), fmt="o", color=BLUE, capsize=4, label="right, 95 % interval")
    means = [sum(each.confidences) / len(each.confidences) for each in found]
    axes.plot(places, means, "_", color=GREY, markersize=22, markeredgewidth=2, label="mean stated confidence")
    labels = [f"{each.label}\n{len(each.confidences)} names" for each in found]
    axes.set_xticks(list(places), labels, fontsize="x-small")
    axes.set_ylim(0.0, 1.03)
    finished(axes, title, "stated confidence", "share of names that were right", loc="lower right")
    return figure
