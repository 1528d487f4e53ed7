"""One number of a model as the fit sees it: a coordinate about 1 wide, bounded, with the step of a derivative.

What is positive by nature (factors, time constants, speeds) is fitted by its logarithm, so that a half and a double are
alike; what may have either sign is fitted as it is, in units of its start value. A fit in well-scaled coordinates needs
neither line searches over decades nor damping by units.
"""

from dataclasses import dataclass
from math import exp, log

import numpy as np

from configs.effects.parameter import Parameter
from symolo.core.arrays import Array

STEP = 1e-3
"""Of a derivative, in coordinates: small beside what a fit resolves, large beside rounding."""
SMALLEST = 1e-4
"""Of a bound at zero on a logarithmic axis, as a share of the start value."""


@dataclass(frozen=True)
class Coordinate:
    name: str
    low: float
    high: float
    null: float | None
    """Coordinate without effect; None of a shape, which does nothing by itself."""
    start: float
    is_log: bool
    unit: float
    """Value of one unit of a linear coordinate; 1 of a logarithmic one."""
    is_time: bool = False
    """Of a delay or a lag, which in a fast log shows at a fraction of what a slow one needs."""

    @classmethod
    def of_parameter(cls, name: str, parameter: Parameter) -> "Coordinate":
        """Of an effect's number."""
        shape = parameter.null is None
        far = parameter.null is not None and parameter.null == parameter.high
        if shape or far or parameter.low > 0.0:
            low = max(parameter.low, SMALLEST * parameter.start)
            null = None if parameter.null is None else log(parameter.null)
            return cls(name, log(low), log(parameter.high), null, log(parameter.start), is_log=True, unit=1.0)
        null_value = 0.0 if parameter.null is None else parameter.null
        unit = abs(parameter.start - null_value)
        return cls(
            name,
            parameter.low / unit,
            parameter.high / unit,
            null_value / unit,
            parameter.start / unit,
            is_log=False,
            unit=unit,
            is_time=parameter.unit == "s",
        )

    @classmethod
    def of_spread(cls, name: str, tolerance: float) -> "Coordinate":
        """Of a nominal parameter, in standard deviations of its tolerance about its value."""
        return cls(name, -np.inf, np.inf, 0.0, 0.0, is_log=False, unit=tolerance)

    def value(self, x: Array) -> Array:
        """Of coordinates, of the same shape."""
        return np.exp(x) if self.is_log else x * self.unit

    def slope(self, x: float) -> float:
        """Change of the value for that of the coordinate."""
        return exp(x) if self.is_log else self.unit

    def coordinate(self, value: float) -> float:
        """Of a value."""
        return log(value) if self.is_log else value / self.unit

    @property
    def is_ceiling(self) -> bool:
        """Whether the effect is absent at the upper bound, as of a limit."""
        return self.null is not None and self.null == self.high
