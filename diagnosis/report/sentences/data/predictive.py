"""The posterior predictive check in words, and as plain data."""

from collections.abc import Sequence
from math import sqrt
from types import MappingProxyType

from diagnosis.posterior.predictive_check import (
    CORRELATION_NAME,
    DRAWS,
    LEVEL,
    MEDIAN_NAME,
    TAIL_NAME,
    WIDTH_NAME,
    CheckedStatistic,
)
from diagnosis.report.sentences.quantities import listed

SLACK_SD = 2.0
"""Standard deviations of the number of statistics that are outside by chance, up to which it counts as chance."""
MEANINGS = MappingProxyType(
    {
        (MEDIAN_NAME, False): "are lower than predicted on average, so that a constant error is left",
        (MEDIAN_NAME, True): "are higher than predicted on average, so that a constant error is left",
        (WIDTH_NAME, False): "scatter less than the fit assumes, so that error bars are wider than need be, "
        "and small deviations may go unnoticed",
        (WIDTH_NAME, True): "scatter more than the fit assumes, so that error bars are too narrow",
        (CORRELATION_NAME, False): "alternate from row to row more than the noise of the fit, as rounded counts do",
        (CORRELATION_NAME, True): "are off in the same direction for several rows, so that a slow error is left",
        (TAIL_NAME, False): "have fewer large errors than the fit assumes",
        (TAIL_NAME, True): "have more large errors than the fit assumes",
    }
)
"""What it means that a statistic is outside, by its name and whether it is above."""


def predictive_sentence(checks: Sequence[CheckedStatistic]) -> str:
    """Return how many statistics of the measured readings lie outside the range of the drawn robots, and what it means
    if they are more than by chance.
    """
    outside = [each for each in checks if each.is_outside]
    expected = (1.0 - LEVEL) * len(checks)
    count = (
        f"{DRAWS} robots from the posterior were simulated in this case, with the noise of the fit. Of {len(checks)} "
        "statistics of the differences from the fitted robot, in standard deviations of the noise, "
        f"{len(outside)} {'lies' if len(outside) == 1 else 'lie'} outside {100.0 * LEVEL:g} % of the robots; "
        f"{expected:.1f} are expected by chance."
    )
    if len(outside) <= expected + SLACK_SD * sqrt(expected):
        return count
    sentences = []
    for (name, is_above), meaning in MEANINGS.items():
        quantities = [each.quantity for each in outside if each.name == name and (each.share_below > 0.5) == is_above]
        if quantities:
            sentences.append(f"{listed([*dict.fromkeys(quantities)])} {meaning}")
    return f"{count} Outside means: {'; '.join(sentences)}."


def in_json(checks: Sequence[CheckedStatistic]) -> list[dict[str, object]]:
    """Return the statistics for answer.json."""
    return [
        {
            "quantity": each.quantity,
            "rows": each.rows,
            "statistic": each.name,
            "measured": each.measured,
            "quantiles": list(each.quantiles),
            "share_below": each.share_below,
        }
        for each in checks
    ]
