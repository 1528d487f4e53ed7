"""Properties of an effect's parameter, defined once: unit, value without effect, start of a fit, and bounds."""

from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema


@dataclass(frozen=True)
class Parameter:
    """Part of a field's annotation. Schema, fit and documentation all take the parameter's properties from here."""

    unit: str
    null: float | None
    """Value at which the effect is absent; None for a parameter of shape, such as a time constant, which has no such
    value."""
    start: float
    """Plausible value with a visible effect, from which a fit starts."""
    low: float
    """Smallest value that a file may contain."""
    high: float
    """Largest value that a file may contain."""
    is_angle: bool = False
    """Whether the parameter is a direction or a phase, for which a whole turn is no change."""
    is_frequency: bool = False
    """Whether the parameter is a number of cycles per turn: a fit has many local optima along it."""
    is_floor: bool = False
    """Whether no sample is below the parameter, so that only the samples show where a fit may start."""
    is_known: bool = False
    """Whether the number has no part in the search for the effect, which takes its default: measurements show it badly
    or not at all."""
    std: float | None = None
    """Standard error of the start, if the start is a value that was measured before, such as that of a discovered law;
    None if the start is only where a fit begins."""
    tries: tuple[float, ...] = ()
    """Further sizes at which the search for the effect begins, relative to the start, if sizes span decades."""
    fit_high: float | None = None
    """Upper bound of a fit to the motor of the paper, if it is lower than that of a file; it grows with the size of the
    motor, as the start does."""

    @property
    def without_effect(self) -> float:
        """Value in an effect that changes nothing; for a parameter of shape it is the start."""
        return self.start if self.null is None else self.null

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:  # noqa: ANN401
        """Return the bounds, for validation and JSON Schema alike."""
        del source, handler
        return core_schema.float_schema(ge=self.low, le=self.high, strict=True, allow_inf_nan=False)


@dataclass(frozen=True)
class Plausible:
    """Part of a field's annotation: range of the sizes that occur in small robots.

    A fit knows no physics beyond its model: without limits it may choose a supply of twenty ohms. The limits are
    generous, for gear motors of a few watts with their drivers, cells and tyres. Of a parameter without limits, any
    size is possible.
    """

    low: float
    high: float
    why: str
    """Reason for the limits."""


Scale = Annotated[float, Parameter("1", null=1.0, start=1.15, low=0.05, high=20.0)]
"""True value over nominal value."""
GeometryScale = Annotated[float, Parameter("1", null=1.0, start=1.05, low=0.5, high=2.0)]
"""True over nominal value of a length or a count that cannot be far off."""
Delay = Annotated[float, Parameter("s", null=0.0, start=0.04, low=0.0, high=0.5)]
LagTime = Annotated[float, Parameter("s", null=0.0, start=0.03, low=0.0, high=2.0)]
DriftTime = Annotated[float, Parameter("s", null=None, start=120.0, low=0.1, high=10_000.0)]
Asymmetry = Annotated[float, Parameter("1", null=0.0, start=0.1, low=-0.9, high=0.9)]
Angle = Annotated[float, Parameter("rad", null=None, start=1.0, low=-6.3, high=6.3, is_angle=True)]
RangeShift = Annotated[float, Parameter("m", null=0.0, start=0.012, low=-0.2, high=0.2)]
