"""How large an effect can be in a small robot at all, so that a name which needs more is ruled out by its size.

A fit knows no physics beyond its model: given the freedom it takes a supply of twenty ohms. The limits here are
generous, what is hardly ever met in gear motors of some watts, their drivers, cells and tyres; each says why.
"""

from collections.abc import Mapping
from dataclasses import dataclass

SURE = 3.0
"""Standard errors by which a size must lie beyond its limit."""


@dataclass(frozen=True)
class Limit:
    low: float
    high: float
    why: str
    """Where the limit comes from."""


@dataclass(frozen=True)
class Beyond:
    """A number of an effect that no robot has."""

    parameter: str
    value: float
    std: float
    limit: float
    """The one it lies beyond."""
    why: str


LIMITS: Mapping[tuple[str, str], Limit] = {
    ("supply_sag", "source_resistance_ohm"): Limit(
        0.0, 1.0, "two lithium cells with protection and leads have 0.1 to 0.5 ohm, four worn alkaline cells 1 ohm"
    ),
    ("winding_resistance_scale", "scale"): Limit(
        0.8, 1.5, "copper gains 0.39 % a kelvin: half as much again would be 130 K"
    ),
    ("torque_constant_scale", "scale"): Limit(
        0.7, 1.2, "ferrite loses 0.2 % a kelvin and comes back; more is lost for good only by demagnetisation"
    ),
    ("speed_scale", "scale"): Limit(
        0.25, 4.0, "a code wheel read by one edge for four, or four for one; other gear ratios lie between"
    ),
    ("encoder_ticks_scale", "scale"): Limit(0.5, 2.0, "one edge counted for two, or two for one"),
    ("bridge_voltage_drop", "drop_V"): Limit(
        0.0, 5.0, "both transistors of an L298 lose 1.8 V at 1 A and at most 4.9 V at 2 A by its datasheet"
    ),
    ("current_sensor_gain", "gain"): Limit(0.5, 2.0, "a shunt of the next value in a series of three a decade"),
    ("wheel_radius_scale", "scale"): Limit(0.9, 1.1, "another tyre would be seen; wear and load are some per cent"),
    ("wheel_radius_asymmetry", "asymmetry"): Limit(-0.1, 0.1, "two wheels of one make; one per cent is much"),
    ("wheelbase_scale", "scale"): Limit(0.9, 1.1, "a tyre touches the floor within its own breadth"),
}
"""By name of the effect and of its number. What is not listed has no size that is impossible."""


def beyond(name: str, values: Mapping[str, float], std: Mapping[str, float]) -> tuple[Beyond, ...]:
    """Which numbers of an effect lie beyond what is plausible, by more than three standard errors.

    Args:
        name: Of the term, without its choice.
        values: Its numbers as fitted.
        std: Their standard errors; one that misses or is infinite excuses any size.
    """
    found = []
    for parameter, value in values.items():
        limit, error = LIMITS.get((name, parameter)), std.get(parameter, float("inf"))
        if limit is None:
            continue
        if value - SURE * error > limit.high:
            found.append(Beyond(parameter, value, error, limit.high, limit.why))
        elif value + SURE * error < limit.low:
            found.append(Beyond(parameter, value, error, limit.low, limit.why))
    return tuple(found)
