"""Limits of the size of effects in a small robot, which rule out a name that would need a larger one.

A fit knows no physics beyond its model: if nothing prevents it, it finds a supply with twenty ohms. The limits are
generous; gear motors of some watts, their drivers, cells and tyres hardly ever exceed them. Each has its reason.
"""

from collections.abc import Mapping
from dataclasses import dataclass

MIN_STANDARD_ERRORS = 3.0
"""Standard errors by which a size must exceed its limit."""


@dataclass(frozen=True)
class Limit:
    """Range of a parameter."""

    low: float
    high: float
    why: str
    """Source of the limit."""


@dataclass(frozen=True)
class Beyond:
    """A parameter of an effect with a value that no robot has."""

    parameter: str
    value: float
    std: float
    limit: float
    """Limit that the value exceeds."""
    why: str


LIMITS: Mapping[tuple[str, str], Limit] = {
    ("supply_sag", "source_resistance_ohm"): Limit(
        0.0, 1.0, "two lithium cells with protection and leads have 0.1 to 0.5 ohm, four worn alkaline cells 1 ohm"
    ),
    ("winding_resistance_scale", "scale"): Limit(0.8, 1.5, "copper gains 0.39 % per kelvin: 50 % more would be 130 K"),
    ("torque_constant_scale", "scale"): Limit(
        0.7, 1.2, "ferrite loses 0.2 % per kelvin, reversibly; only demagnetisation loses more"
    ),
    ("speed_scale", "scale"): Limit(
        0.25, 4.0, "a code wheel counted with one edge instead of four, or the reverse; other gear ratios lie between"
    ),
    ("encoder_ticks_scale", "scale"): Limit(0.5, 2.0, "one edge counted instead of two, or two instead of one"),
    ("bridge_voltage_drop", "drop_V"): Limit(
        0.0, 5.0, "both transistors of an L298 lose 1.8 V at 1 A and at most 4.9 V at 2 A by its datasheet"
    ),
    ("current_sensor_gain", "gain"): Limit(
        0.5, 2.0, "a shunt of the next value in a series with three values per decade"
    ),
    ("wheel_radius_scale", "scale"): Limit(
        0.9, 1.1, "another tyre would be visible; wear and load change it by a few per cent"
    ),
    ("wheel_radius_asymmetry", "asymmetry"): Limit(-0.1, 0.1, "two wheels of the same type; one per cent is much"),
    ("wheelbase_scale", "scale"): Limit(0.9, 1.1, "a tyre touches the floor within its own width"),
}
"""Limits by effect and parameter; parameters that are not listed have none."""


def beyond(name: str, values: Mapping[str, float], std: Mapping[str, float]) -> tuple[Beyond, ...]:
    """Return the parameters of an effect that exceed their limits by more than three standard errors.

    Args:
        name: Name of the effect, without its choice.
        values: Fitted values of its parameters.
        std: Their standard errors; without a finite one, any size is accepted.
    """
    excesses = []
    for parameter, value in values.items():
        limit, error = LIMITS.get((name, parameter)), std.get(parameter, float("inf"))
        if limit is None:
            continue
        if value - MIN_STANDARD_ERRORS * error > limit.high:
            excesses.append(Beyond(parameter, value, error, limit.high, limit.why))
        elif value + MIN_STANDARD_ERRORS * error < limit.low:
            excesses.append(Beyond(parameter, value, error, limit.low, limit.why))
    return tuple(excesses)
