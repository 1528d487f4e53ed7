"""What a term is: one named effect, at one place of the signal chain, with one pure function."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property, partial
from types import MappingProxyType
from typing import Any, get_args

from configs.schema.base import Section
from configs.schema.effects.parameter import Parameter
from configs.schema.effects.table import TERM_NAMES, Terms


class Slot(StrEnum):
    """The places of the signal chain, and what a function there takes after its values and gives back.

    Arrays of wheels have the wheels as their last axis, right and left; a motor alone on a bench has one of length 1.
    """

    MOTORS = "motors"
    """Motors -> Motors."""
    COMMAND_DELAY = "command delay"
    """delay [s] -> delay [s]."""
    ACTUATOR = "actuator"
    """held voltage [V], wanted voltage [V], duration [s] -> voltage [V] after it."""
    BATTERY = "battery"
    """voltage [V], time since the start [s] -> voltage [V]."""
    BRIDGE = "bridge"
    """voltage that drives the current, u - K w [V] -> the same."""
    SUPPLY = "supply"
    """u - K w [V] before the bridge's own loss, `Bridge` -> current [A]."""
    CURRENT_LIMIT = "current limit"
    """current [A] -> current [A]."""
    FRICTION = "friction"
    """friction torque against the motion [N m], `Motion` -> the same."""
    GEARBOX = "gearbox"
    """`TwoMass`, `Load` of motor side and load side, duration [s] -> `TwoMass`."""
    GEOMETRY = "geometry"
    """WheelGeometry -> WheelGeometry."""
    GROUND = "ground"
    """share of the yaw rate that is left, speed [m/s], yaw rate [rad/s], both by the wheels -> share."""
    ENCODER = "encoder"
    """counts per revolution -> counts per revolution."""
    COUNTING = "counting"
    """angle turned [rad], duration [s] -> angle that is counted [rad]."""
    CURRENT_READING = "current reading"
    """current [A] -> current [A]."""
    SPEED_READING = "speed reading"
    """speed [rad/s] -> speed [rad/s]."""
    SPEED_FILTER = "speed filter"
    """filtered speed [rad/s], speed then and now [rad/s], duration [s] between -> filtered speed [rad/s] now."""
    SPEED_DELAY = "speed delay"
    """delay [s] -> delay [s]."""
    POSE_POINT = "pose point"
    """pose x [m], y [m], yaw [rad] (..., 3) -> the same."""
    POSE_DELAY = "pose delay"
    """delay [s] -> delay [s]."""
    RANGE_MOUNT = "range mount"
    """yaw of the three sensors [rad] (3,) -> the same."""
    RANGE = "range"
    """reading [m], `RangeView` -> reading [m]."""
    RANGE_NOISE = "range noise"
    """standard deviation [m], `RangeView` -> standard deviation [m]."""
    RANGE_LIMIT = "range limit"
    """reading [m] with its noise, rounded -> reading [m]."""
    RANGE_DELAY = "range delay"
    """delay [s] -> delay [s]."""


@dataclass(frozen=True)
class Term:
    """One effect. Its parameters, with their units, null and start values and bounds, are those of the schema."""

    parameters: type[Section]
    slot: Slot
    cause: str
    """What in a robot brings it about."""
    excitation: str
    """What a measurement must contain to reveal it."""
    apply: Callable[..., Any]
    """Pure; takes the parameters' values first, then what the slot says."""

    @property
    def name(self) -> str:
        return TERM_NAMES[self.parameters]

    @cached_property
    def numbers(self) -> Mapping[str, Parameter]:
        """The parameters that can be fitted."""
        found = {
            name: parameter
            for name, field in self.parameters.model_fields.items()
            for parameter in field.metadata
            if isinstance(parameter, Parameter)
        }
        return MappingProxyType(found)

    @cached_property
    def options(self) -> Mapping[str, tuple[str, ...]]:
        """Values of each discrete parameter; none where any name goes."""
        fields = self.parameters.model_fields
        return MappingProxyType({n: get_args(f.annotation) for n, f in fields.items() if n not in self.numbers})

    def values(self, numbers: Mapping[str, float], choices: Mapping[str, str] = MappingProxyType({})) -> Section:
        """The parameters with these numbers and choices, checked against their bounds."""
        return self.parameters.model_validate({**numbers, **choices})

    def null(self, choices: Mapping[str, str] = MappingProxyType({})) -> Section:
        """Values at which the effect is absent."""
        return self.values({n: p.start if p.null is None else p.null for n, p in self.numbers.items()}, choices)

    def start(self, choices: Mapping[str, str] = MappingProxyType({})) -> Section:
        """Plausible values with a visible effect."""
        return self.values({n: p.start for n, p in self.numbers.items()}, choices)


def effects(table: Sequence[Term], terms: Terms, slot: Slot) -> tuple[Callable[..., Any], ...]:
    """The functions that a robot's terms put into a slot, in the table's order."""
    found = ((term, getattr(terms, term.name)) for term in table if term.slot is slot)
    return tuple(partial(term.apply, values) for term, values in found if values is not None)
