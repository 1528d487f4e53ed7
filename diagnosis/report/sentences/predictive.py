"""The posterior predictive check in words, and as plain data."""

from collections.abc import Sequence

from diagnosis.posterior.predictive_check import DRAWS, LEVEL, CheckedStatistic


def predictive_sentence(checks: Sequence[CheckedStatistic]) -> str:
    """Return how many statistics of the measured readings lie outside the range of the drawn robots."""
    outside = sum(each.is_outside for each in checks)
    return (
        f"{DRAWS} robots from the posterior were simulated in this case, with the noise of the fit. Of {len(checks)} "
        "statistics of the differences from the fitted robot, in standard deviations of the noise, "
        f"{outside} {'lies' if outside == 1 else 'lie'} outside {100.0 * LEVEL:g} % of the robots; "
        f"{(1.0 - LEVEL) * len(checks):.1f} are expected by chance."
    )


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
