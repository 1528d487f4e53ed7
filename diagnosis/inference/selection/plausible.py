"""Fitted sizes of effects that no small robot has, so that the data need another explanation."""

from collections.abc import Mapping
from dataclasses import dataclass

from configs.effects.base import Effect

MIN_STANDARD_ERRORS = 3.0
"""Standard errors by which a size must lie beyond its limit."""


@dataclass(frozen=True)
class Beyond:
    """A number of an effect that no robot has."""

    parameter: str
    value: float
    std: float
    limit: float
    """The limit that the value lies beyond."""
    why: str
    """Reason for the limit."""


def beyond(effect: type[Effect], values: Mapping[str, float], std: Mapping[str, float]) -> tuple[Beyond, ...]:
    """Return the numbers of an effect that lie beyond their plausible sizes by more than three standard errors.

    Args:
        effect: The effect.
        values: Fitted numbers by parameter.
        std: Standard errors by parameter; one that is missing or infinite excuses any size.
    """
    impossible = []
    for parameter, plausible in effect.plausible_sizes().items():
        value, error = values[parameter], std.get(parameter, float("inf"))
        if value - MIN_STANDARD_ERRORS * error > plausible.high:
            impossible.append(Beyond(parameter, value, error, plausible.high, plausible.why))
        elif value + MIN_STANDARD_ERRORS * error < plausible.low:
            impossible.append(Beyond(parameter, value, error, plausible.low, plausible.why))
    return tuple(impossible)
