"""Effects in a time-of-flight range sensor, as its bench shows them."""

from typing import Annotated

from configs.schema.base import Fixed, Section, Slug
from configs.schema.effects.parameter import DriftTime, GeometryScale, Parameter, RangeShift, Scale

MaterialName = Annotated[Slug, Fixed("a name is text")]
"""A surface of `physics.arena.surfaces` in the simulation, on a bench whatever its list of materials names."""


class RangeOffset(Section):
    offset_m: RangeShift
    """reading + offset."""


class RangeScale(Section):
    scale: GeometryScale
    """reading = scale * distance."""


class LogRangeError(Section):
    coefficient_m: Annotated[float, Parameter("m", null=0.0, start=0.02, low=-0.3, high=0.3)]
    """reading + coefficient * ln(distance / 0.18 m) beyond 0.18 m."""


class TemperatureDrift(Section):
    coefficient_m_per_K: Annotated[float, Parameter("m/K", null=0.0, start=6e-4, low=-0.01, high=0.01)]
    """reading + coefficient * (temperature - reference temperature)."""


class MaterialBias(Section):
    material: MaterialName
    offset_m: RangeShift
    """reading + offset on that one material."""


class IncidenceBias(Section):
    coefficient: Annotated[float, Parameter("1", null=0.0, start=0.08, low=-2.0, high=2.0)]
    """reading + coefficient * distance * sin^2(incidence)."""


class CoverCrosstalk(Section):
    strength_per_m2: Annotated[float, Parameter("1/m2", null=0.0, start=0.05, low=0.0, high=10.0)]
    """reading = distance / (1 + strength * distance^2 / reflectance)."""


class NearFieldError(Section):
    amplitude_m: Annotated[float, Parameter("m", null=0.0, start=0.02, low=-0.2, high=0.2)]
    """reading + amplitude * exp(-distance / decay_length)."""
    decay_length_m: Annotated[float, Parameter("m", null=None, start=0.08, low=0.005, high=2.0)]


class RangeSaturation(Section):
    saturation_m: Annotated[float, Parameter("m", null=100.0, start=0.5, low=0.05, high=100.0)]
    """reading <= saturation; the upper bound stands for none."""


class WarmupDrift(Section):
    amplitude_m: Annotated[float, Parameter("m", null=0.0, start=0.01, low=-0.2, high=0.2)]
    """reading + amplitude * exp(-t / time_constant), t since power-on."""
    time_constant_s: DriftTime


class NoiseScale(Section):
    scale: Scale
    """Standard deviation of the noise * scale."""


class AmbientNoise(Section):
    coefficient_per_klux: Annotated[float, Parameter("1/klux", null=0.0, start=0.3, low=0.0, high=100.0)]
    """Variance of the noise * (1 + coefficient * ambient light / 1000 lux)."""
