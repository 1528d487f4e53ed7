"""The signature matrix as a table: how far each effect moves each quantity, and from which size it would be named."""

from collections.abc import Iterator
from math import isfinite, isinf, log10

from diagnosis.inference.likelihood import SPREAD
from diagnosis.report.findings import Findings
from diagnosis.report.quantities import meaning
from diagnosis.report.signatures import STILL, Signature
from symolo.pages.markup import Html, table, tag

DEEPEST_SIGMA = 30.0
"""From which a cell has its full colour."""


def matrix(found: Findings) -> Iterator[Html]:
    """Paragraphs and the table."""
    signatures = found.signatures
    told = (
        "Each effect switched on at the size in the second column: how far it moves each quantity on average, in "
        "sigmas of the noise (× is a factor on the noise itself). The last column is the distance from nothing, of the "
        "first number, from which rows like these would name it, were it alone; what the tolerances of the nominal "
        "parameters can take up does not count."
    )
    yield tag("p", told, class_="note")
    names = {of.effect.name for of in found.diagnosis.named}
    head = ["effect", "switched on at", *signatures.quantities, "named from"]
    rows = [_row(of, named=of.effect.name in names) for of in signatures.rows]
    yield table(head, rows, class_="matrix")
    if signatures.alike:
        yield tag("p", "Look alike in these data, whatever is found (cosine of their changes):")
        yield tag("ul", [tag("li", f"{a} and {b} ({cosine:.3f})") for a, b, cosine in signatures.alike])


def _row(of: Signature, *, named: bool) -> list[str]:
    name = tag("strong", of.effect.name) if named else tag("span", of.effect.name, title=meaning(of.effect.kind))
    cells = [_cell(moved, wider) for moved, wider in zip(of.moves, of.spreads, strict=True)]
    return [name, of.start, *cells, _smallest(of)]


def _cell(moved: float, wider: float) -> Html:
    if moved < STILL and abs(wider - 1.0) > STILL:
        return tag("td", f"× {wider:.2f}", style=_shade(SPREAD * abs(wider - 1.0)))
    if moved < STILL:
        return tag("td", "·")
    return tag("td", f"{moved:.2g}" if moved < 10.0 else f"{moved:.0f}", style=_shade(moved))


def _shade(sigma: float) -> str:
    """Deeper for more, by its logarithm from 0.01 sigma on; see-through, so that it fits light and dark."""
    depth = min(max((log10(max(sigma, 1e-9)) + 2.0) / (log10(DEEPEST_SIGMA) + 2.0), 0.0), 1.0)
    return f"background: rgba(0, 114, 178, {0.6 * depth:.2f})"


def _smallest(of: Signature) -> str:
    if isinf(of.smallest):
        return "never"
    if not isfinite(of.smallest):
        return "-"
    unit = next(iter(of.effect.kind.parameters().values())).unit
    return f"{of.smallest:.2g}{'' if unit == '1' else f' {unit}'}"
