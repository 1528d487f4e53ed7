"""One parameter of a model as the fit sees it: a bounded coordinate about 1 wide.

Parameters that are positive by nature (factors, time constants, speeds) are fitted by their logarithm, so that half and
double are equally far away. Parameters of either sign are fitted linearly, in units of their start value. In such
well-scaled coordinates a fit needs neither line searches over decades nor damping by units.
"""

from dataclasses import dataclass
from math import exp, log

import numpy as np

from configs.effects.parameter import Parameter
from symolo.core.arrays import Array

STEP = 1e-3
"""Step of a derivative, in coordinates: far below what a fit resolves, far above rounding errors."""
MIN_LOG_SHARE = 1e-4
"""Lower bound of a logarithmic coordinate whose parameter is bounded by zero, as a share of the start value."""


@dataclass(frozen=True)
class Coordinate:
    """The coordinate of one parameter."""

    name: str
    low: float
    high: float
    null: float | None
    """Coordinate at which the effect is absent; None for a shape parameter, which does nothing by itself."""
    start: float
    is_log: bool
    unit: float
    """Value of one unit of a linear coordinate; 1 for a logarithmic one."""
    is_angle: bool = False
    """Whether the parameter is a direction or a phase."""
    is_frequency: bool = False
    """Whether the parameter is a number of cycles per turn. The cost has a local optimum every few hundredths."""
    is_time: bool = False
    """Whether the parameter is a delay or a lag. Fast logs show much shorter ones than slow logs."""
    is_floor: bool = False
    """Whether the parameter is a limit below which there is no sample."""
    tries: tuple[float, ...] = ()
    """Further sizes to try, relative to the distance of the start from the null value."""

    @classmethod
    def from_parameter(cls, name: str, parameter: Parameter, scale: float = 1.0) -> "Coordinate":
        """Return the coordinate of an effect's parameter, whose start is multiplied by `scale`."""
        if parameter.is_angle or parameter.is_frequency:
            return cls(
                name,
                parameter.low,
                parameter.high,
                None,
                parameter.start,
                is_log=False,
                unit=1.0,
                is_angle=parameter.is_angle,
                is_frequency=parameter.is_frequency,
            )
        is_ceiling = parameter.null is not None and parameter.null == parameter.high
        if parameter.null is None or is_ceiling or parameter.low > 0.0:
            start = min(max(scale * parameter.start, parameter.low), parameter.high)
            low = log(max(parameter.low, MIN_LOG_SHARE * start))
            null = None if parameter.null is None else log(parameter.null)
            high = parameter.high
            if parameter.fit_high is not None:
                high = min(high, max(scale, 1.0) * parameter.fit_high)
            return cls(name, low, log(high), null, log(start), is_log=True, unit=1.0)
        unit = abs(scale * (parameter.start - parameter.null))
        start = parameter.null + scale * (parameter.start - parameter.null)
        low, high, null, start = (x / unit for x in (parameter.low, parameter.high, parameter.null, start))
        is_time = parameter.unit == "s"
        return cls(
            name,
            low,
            high,
            null,
            start,
            is_log=False,
            unit=unit,
            is_time=is_time,
            is_floor=parameter.is_floor,
            tries=parameter.tries,
        )

    @classmethod
    def from_tolerance(
        cls, name: str, tolerance: float, bounds: tuple[float, float] = (-np.inf, np.inf)
    ) -> "Coordinate":
        """Return the coordinate of a nominal parameter: its deviation in standard deviations of its tolerance.

        Args:
            name: Name of the parameter.
            tolerance: Its tolerance.
            bounds: Smallest and largest deviation, in tolerances.
        """
        return cls(name, *bounds, 0.0, 0.0, is_log=False, unit=tolerance)

    def value(self, x: Array) -> Array:
        """Return the values of the parameter for coordinates of any shape."""
        return np.exp(x) if self.is_log else x * self.unit

    def slope(self, x: float) -> float:
        """Return the derivative of the value by the coordinate."""
        return exp(x) if self.is_log else self.unit

    def coordinate(self, value: float) -> float:
        """Return the coordinate of a value."""
        return log(value) if self.is_log else value / self.unit

    @property
    def is_ceiling(self) -> bool:
        """Whether the effect is absent at the upper bound, as a limit is."""
        return self.null is not None and self.null == self.high
