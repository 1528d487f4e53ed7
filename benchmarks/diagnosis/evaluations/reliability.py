"""Whether names are right as often as the confidence reported with them says.

    python benchmarks/diagnosis/evaluations/reliability.py --truth CASES/truth.json --answers ANSWERS --out FILE

This command prints the table and draws the diagram for independent cases (benchmarks/diagnosis/independent_cases). For
cases of our own generator, hide_and_find.py does it.
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

# Scripts are run by their path.
sys.path.insert(0, str(Path(__file__).parents[3]))

from figures import interval
from matplotlib.figure import Figure
from score import Score

from benchmarks.diagnosis.independent_cases import judge
from symolo.pages.plotting import BLUE, GREY, finished, png

EDGES = (0.0, 0.5, 0.8, 0.9, 0.95, 0.99, 0.999)
"""Lower edges of the bins; the last one holds what the report calls over 99.9 % sure."""


@dataclass(frozen=True)
class StatedName:
    """A name of an answer.

    Attributes:
        confidence: Stated confidence.
        right: Whether it was hidden.
        alike: Whether it was hidden, or the data cannot tell it from what was.
    """

    confidence: float
    right: bool
    alike: bool


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


def main() -> None:
    """Print the table of independent cases and draw their diagram."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--truth", type=Path, required=True, help="truth.json of the cases")
    parser.add_argument("--answers", type=Path, required=True, help="folder of the answers")
    parser.add_argument("--out", type=Path, required=True, help="the diagram, a png file")
    arguments = parser.parse_args()
    cases = judge.answered(arguments.truth, arguments.answers)
    names = [StatedName(*name) for truth, answer in cases for name in judge.stated_names(truth, answer)]
    print("\n".join(reliability_table(names)))
    arguments.out.write_bytes(png(reliability_figure(names, f"{len(names)} names in {len(cases)} independent cases")))


def names_of(scores: Sequence[Score]) -> list[StatedName]:
    """Return the names in the answers to cases of our own generator."""
    columns = [zip(each.confidences, each.name_hits, each.name_alike, strict=True) for each in scores]
    return [StatedName(*name) for each in columns for name in each]


def bins(names: Sequence[StatedName]) -> list[Bin]:
    """Return the bins that hold a name."""
    filled = []
    for low, high in zip(EDGES, (*EDGES[1:], 2.0), strict=True):
        inside = [name for name in names if low <= name.confidence < high]
        if inside:
            confidences = tuple(name.confidence for name in inside)
            filled.append(Bin(low, confidences, sum(name.right for name in inside), sum(name.alike for name in inside)))
    return filled


def reliability_table(names: Sequence[StatedName]) -> list[str]:
    """Return lines to print: how many names of each confidence were right, with the 95 % interval after Wilson."""
    lines = [f"{'stated confidence':18s} {'names':>6s} {'mean':>7s} {'right':>6s} {'share':>24s}  right or alike"]
    for each in bins(names):
        count = len(each.confidences)
        low, high = interval(each.right, count)
        share = f"{100 * each.right / count:.1f} % ({100 * low:.1f}-{100 * high:.1f})"
        mean = 100 * sum(each.confidences) / count
        lines.append(f"{each.label:18s} {count:6d} {mean:6.1f}% {each.right:6d} {share:>24s}  {each.alike}")
    return lines


def reliability_figure(names: Sequence[StatedName], title: str) -> Figure:
    """Return the share of right names over the mean confidence of their bin, with Wilson intervals."""
    figure = Figure(figsize=(6.0, 4.4), layout="constrained")
    axes = figure.subplots()
    filled = bins(names)
    places = range(len(filled))
    shares = [each.right / len(each.confidences) for each in filled]
    limits = [interval(each.right, len(each.confidences)) for each in filled]
    below = [max(share - low, 0.0) for share, (low, _) in zip(shares, limits, strict=True)]
    over = [max(high - share, 0.0) for share, (_, high) in zip(shares, limits, strict=True)]
    axes.errorbar(places, shares, (below, over), fmt="o", color=BLUE, capsize=4, label="right, 95 % interval")
    means = [sum(each.confidences) / len(each.confidences) for each in filled]
    axes.plot(places, means, "_", color=GREY, markersize=22, markeredgewidth=2, label="mean stated confidence")
    labels = [f"{each.label}\n{len(each.confidences)} names" for each in filled]
    axes.set_xticks(list(places), labels, fontsize="x-small")
    axes.set_ylim(0.0, 1.03)
    finished(axes, title, "stated confidence", "share of names that were right", loc="lower right")
    return figure


if __name__ == "__main__":
    main()
