"""The comparison of a dataset with a measured drive, for a terminal, for the page and for programs."""

from collections.abc import Iterator

import numpy as np

from diagnosis.dataset_comparison import DatasetComparison, QuantityComparison, ResidualComparison
from diagnosis.report.sentences.quantities import axis, percent

MAX_RUNS = 12
"""Runs in the table of the page."""


def verdict(comparison: DatasetComparison) -> list[str]:
    """Return one sentence about the whole drive, and one for each quantity that is not covered."""
    count = len(comparison.runs)
    runs = "its run" if count == 1 else f"its {count} runs"
    gaps = [_median_gap(residual) for residual in comparison.residuals if not residual.is_covered]
    gaps += [_scatter_gap(residual) for residual in comparison.residuals if not residual.scatters_alike]
    gaps += [_range_gap(signal) for signal in comparison.signals if not signal.is_covered]
    if not gaps:
        return [f"The dataset {comparison.release} covers the measured drive: nothing of it lies outside {runs}."]
    return [f"The dataset {comparison.release} with {runs} does not cover the measured drive:", *gaps]


def _median_gap(residual: ResidualComparison) -> str:
    low, high = min(residual.middles), max(residual.middles)
    return (
        f"The measured {residual.name} differs from the nominal robot by {_signed(residual.middle)} {residual.unit} "
        f"(median), that of the runs by {_signed(low)} to {_signed(high)} {residual.unit}: no robot of the dataset is "
        "like the measured one."
    )


def _scatter_gap(residual: ResidualComparison) -> str:
    low, high = f"{min(residual.scatters):.2g}", f"{max(residual.scatters):.2g}"
    runs = low if low == high else f"{low} to {high}"
    return (
        f"The residuals of {residual.name} scatter by {residual.scatter:.2g} {residual.unit}, those of the runs by "
        f"{runs} {residual.unit}."
    )


def _range_gap(signal: QuantityComparison) -> str:
    low, high = signal.pooled.min(), signal.pooled.max()
    return (
        f"{percent(signal.outside)} of the samples of {signal.name} are outside the dataset's range of {low:.3g} to "
        f"{high:.3g} {signal.unit}."
    )


def signal_rows(comparison: DatasetComparison) -> Iterator[tuple[str, ...]]:
    """Yield the table of signals: name, measured and simulated quantiles, share outside, distance."""
    for signal in comparison.signals:
        quantiles = []
        for values in (signal.measured, signal.pooled):
            low, middle, high = np.quantile(values, [0.05, 0.5, 0.95]).tolist()
            quantiles.append(f"{middle:.3g} ({low:.3g} to {high:.3g})")
        yield axis(signal.name), *quantiles, percent(signal.outside), f"{signal.apart:.2f}"


def residual_rows(comparison: DatasetComparison) -> Iterator[tuple[str, ...]]:
    """Yield the table of residuals: a row for the measured drive and for each run."""
    residuals = comparison.residuals
    yield "measured", *(f"{_signed(residual.middle)} ± {residual.scatter:.2g}" for residual in residuals)
    count = len(residuals[0].runs)
    for k in range(min(count, MAX_RUNS)):
        # Runs with few samples are left out of the residuals, and then the names do not match them.
        name = comparison.runs[k] if len(comparison.runs) == count else f"run {k + 1}"
        yield name, *(f"{_signed(residual.middles[k])} ± {residual.scatters[k]:.2g}" for residual in residuals)
    if count > MAX_RUNS:
        ends = (f"{_signed(min(residual.middles))} to {_signed(max(residual.middles))}" for residual in residuals)
        yield f"all, with {count - MAX_RUNS} more", *ends


def _signed(value: float) -> str:
    return f"{value:+.2g}"


def in_json(comparison: DatasetComparison) -> dict[str, object]:
    """Return the comparison for answer.json."""
    return {
        "release": comparison.release,
        "runs": len(comparison.runs),
        "seen": {
            signal.name: {
                "unit": signal.unit,
                "outside": signal.outside,
                "apart": signal.apart,
                "covered": signal.is_covered,
            }
            for signal in comparison.signals
        },
        "left": {
            residual.name: {
                "unit": residual.unit,
                "middle": residual.middle,
                "middles": [min(residual.middles), max(residual.middles)],
                "scatter": residual.scatter,
                "scatters": [min(residual.scatters), max(residual.scatters)],
                "covered": residual.is_covered,
            }
            for residual in comparison.residuals
        },
    }
