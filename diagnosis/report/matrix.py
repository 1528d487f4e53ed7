"""The signature matrix: how far each effect moves each quantity, and from which size it would be named."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import isfinite, isinf, log10

from diagnosis.report.report_data import ReportData
from diagnosis.report.sentences.quantities import meaning
from diagnosis.report.signatures import STILL, EffectSignature

_MAX_SHADE_SIGMA = 30.0
"""Change at which a cell has its full colour."""


@dataclass(frozen=True)
class MatrixRow:
    """One effect of the matrix."""

    name: str
    meaning: str
    is_named: bool
    start: str
    """Size at which the effect is switched on, such as `scale = 1.15`."""
    cells: tuple[tuple[str, float], ...]
    """Change of each quantity as text, and the opacity of its colour, 0 to 1."""
    smallest: str
    """Smallest size that would be named."""


def matrix_rows(data: ReportData) -> Iterator[MatrixRow]:
    """Yield a row for each effect that the data can show, the most visible first."""
    named = {effect.effect.name for effect in data.diagnosis.named}
    for row in data.signatures.rows:
        effect = row.effect
        cells = tuple(_cell(moved, spread) for moved, spread in zip(row.moves, row.spreads, strict=True))
        yield MatrixRow(effect.name, meaning(effect.kind), effect.name in named, row.start, cells, _smallest(row))


def _cell(moved: float, spread: float) -> tuple[str, float]:
    if moved >= STILL:
        return f"{moved:.2g}" if moved < 10.0 else f"{moved:.0f}", _opacity(moved)
    if abs(spread - 1.0) > STILL:
        return f"× {spread:.2f}", _opacity(abs(spread - 1.0))
    return "·", 0.0


def _opacity(sigma: float) -> float:
    """Return the opacity of a change: linear in its logarithm from 0.01 sigma on, and readable on light and dark."""
    depth = (log10(max(sigma, 1e-9)) + 2.0) / (log10(_MAX_SHADE_SIGMA) + 2.0)
    return 0.6 * min(max(depth, 0.0), 1.0)


def _smallest(row: EffectSignature) -> str:
    if isinf(row.smallest):
        return "never"
    if not isfinite(row.smallest):
        return "-"
    unit = next(iter(row.effect.kind.parameters().values())).unit
    return f"{row.smallest:.2g}{'' if unit == '1' else f' {unit}'}"
