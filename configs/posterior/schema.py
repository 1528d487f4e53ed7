"""The posterior of a diagnosis: which robots agree with the measured data, and how well.

A hypothesis is a set of effects with all numbers of the robot that were fitted. These numbers have a joint normal
distribution, in coordinates in which the fit is nearly Gaussian: the logarithm of numbers that are positive by nature,
and the numbers themselves otherwise. It is cut off at the bounds of the numbers.
"""

from typing import Annotated, Literal

from pydantic import Field, model_validator
from typing_extensions import Self

from configs.schema.base import Fixed, FromList, Section, Slug, disagreement
from configs.schema.code_file import CodeFile
from configs.schema.effect_range import EffectRange
from symolo.core.yaml.tree import FieldPath

VERSION = 1
FILE = "posterior.yaml"
SUM_TOLERANCE = 1e-3
"""Deviation of the sum of the weights from 1 by rounding."""

_WRITTEN = Fixed("the diagnosis computed it")
Number = Annotated[float, Field(ge=-1e300, le=1e300), _WRITTEN]
Share = Annotated[float, Field(ge=0.0, le=1.0), _WRITTEN]
Name = Annotated[str, Field(max_length=200), _WRITTEN]
RobotField = Annotated[
    str,
    Field(pattern=r"^(chassis|drive|motor|power|encoder|line_sensor|tof|effects)(\.[A-Za-z0-9_]+)+$", max_length=200),
    _WRITTEN,
]
Value = Annotated[bool | int | float | str | None, _WRITTEN]
"""Value of a field; null stands for a field or an effect that the robot does not have."""


class FixedField(Section):
    """A field of the robot that is not drawn, such as a number from the data sheet of the measured robot."""

    field: RobotField
    """Path of the field below `robot`."""
    value: Value
    """Value in every drawn robot."""
    replaces: Value
    """Value of the robot that the diagnosis extends."""


class FittedNumber(Section):
    """One number of the robot that is drawn."""

    field: RobotField
    """Path of the number below `robot`."""
    unit: Name
    """Unit of the number."""
    scale: Literal["linear", "log"]
    """Coordinate with the normal distribution: the number or its natural logarithm."""
    mean: Number
    """Mean of the coordinate, before the distribution is cut off."""
    low: Number
    """Smallest possible number."""
    high: Number
    """Largest possible number."""
    replaces: Value
    """Value of the robot that the diagnosis extends."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.low > self.high:
            raise disagreement("low", self.low, f"at most high, which is {self.high:g}")
        if self.scale == "log" and self.low < 0.0:
            raise disagreement("low", self.low, "0 or more, because of the scale log")
        return self


class RobotHypothesis(Section):
    """The robot with one set of effects."""

    name: Name
    """Names of its effects, or `no effect`."""
    weight: Share
    """Probability, if one of the hypotheses is right."""
    left_out: Annotated[tuple[Name, ...], FromList]
    """Effects of the hypothesis that no drive can simulate, so that the drawn robots lack them."""
    not_determined: Annotated[tuple[RobotField, ...], FromList]
    """Numbers that the data do not determine at all; they have their fitted value."""
    fixed: Annotated[tuple[FixedField, ...], FromList]
    """Fields that differ from those of the robot that the diagnosis extends, and are not drawn."""
    numbers: Annotated[tuple[FittedNumber, ...], FromList]
    """Numbers that are drawn together."""
    factor: Annotated[
        tuple[Annotated[tuple[Number, ...], FromList], ...],
        FromList,
        Field(description="Lower triangular matrix L with a row for each number: the covariance of the numbers is LL'"),
    ]
    effect_ranges: Annotated[tuple[EffectRange, ...], FromList]
    """Ranges in which the effects were observed."""

    @model_validator(mode="after")
    def _complete(self) -> Self:
        rows = len(self.numbers)
        if len(self.factor) != rows:
            raise disagreement("factor", f"{len(self.factor)} rows", f"{rows} rows, one for each of numbers")
        for place, row in enumerate(self.factor):
            if len(row) > place + 1:
                raise disagreement(
                    "factor", f"{len(row)} numbers in row {place + 1}", f"at most {place + 1} in that row"
                )
        fields = [each.field for each in (*self.fixed, *self.numbers)]
        if len(set(fields)) < len(fields):
            twice = next(field for field in fields if fields.count(field) > 1)
            raise disagreement("", twice, "each field once, in fixed or in numbers")
        return self

    @property
    def paths(self) -> dict[FieldPath, Value]:
        """Value that the extended robot has in the place of each field, by its path in a scenario."""
        return {path_of(each.field): each.replaces for each in (*self.fixed, *self.numbers)}


class MeasuredRange(Section):
    """Range of one quantity over all samples that were used."""

    covariate: Name
    """Name of the quantity in the diagnosis."""
    quantity: (
        Annotated[Literal["v_m_s", "w_rad_s", "wheel_speed_rad_s", "voltage_V", "current_A", "tof_m"], _WRITTEN] | None
    )
    """The quantity of a simulated run that corresponds to it; null for none."""
    low: Number
    """Smallest measured value, in the unit at the end of the name."""
    high: Number
    """Largest measured value."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.low > self.high:
            raise disagreement("low", self.low, f"at most high, which is {self.high:g}")
        return self


class ChannelNoise(Section):
    """Scatter of one channel about the predictions, which no hypothesis explains."""

    channel: Name
    """Name of the channel."""
    unit: Name
    """Unit of the channel."""
    sd: Annotated[float, Field(ge=0.0, le=1e300), _WRITTEN]
    """Median standard deviation of good readings."""
    level: Annotated[float, Field(ge=0.0, le=1e300), _WRITTEN]
    """Standard deviation relative to that of the nominal robot."""
    outliers: Share
    """Share of readings that are outliers."""


class Posterior(Section):
    """Distribution of the robots that agree with measured data, as `symolo diagnose` writes it (`posterior.yaml`)."""

    version: Literal[1]
    """Version of the format."""
    source: Name
    """Measurement, and its kind."""
    robot: Slug
    """Name of the robot that the diagnosis extends; it must be the robot of the scenario."""
    something_else: Share
    """Probability that none of the hypotheses is right."""
    unexplained: Name
    """Channel and covariate of the structure that no hypothesis explains; empty if there is none."""
    hypotheses: Annotated[tuple[RobotHypothesis, ...], FromList, Field(min_length=1, max_length=100)]
    """Hypotheses that the data do not distinguish, the most probable one first."""
    measured: Annotated[tuple[MeasuredRange, ...], FromList]
    """Range of each quantity that was measured."""
    noise: Annotated[tuple[ChannelNoise, ...], FromList]
    """Scatter of each channel that stays unexplained."""
    effect_files: Annotated[tuple[CodeFile, ...], FromList] = ()
    """Files of the effects of your own."""

    @model_validator(mode="after")
    def _weights_sum_to_one(self) -> Self:
        total = sum(each.weight for each in self.hypotheses)
        if abs(total - 1.0) > SUM_TOLERANCE:
            raise disagreement("hypotheses", f"weights with the sum {total:.4g}", "weights with the sum 1")
        return self


class LoadedPosterior(Posterior):
    """A posterior with the SHA-256 of its file, as the specification of a dataset contains it."""

    sha256: Annotated[str, _WRITTEN] = Field(pattern=r"^[0-9a-f]{64}$")
    """SHA-256 of posterior.yaml."""


class DrawnFrom(Section):
    """The posterior from which the robot of a run was drawn."""

    sha256: str = Field(pattern=r"^[0-9a-f]{64}$")
    """SHA-256 of posterior.yaml."""
    hypothesis: str
    """Name of the drawn hypothesis."""
    measured: Annotated[tuple[MeasuredRange, ...], FromList] = ()
    """Ranges that were measured; a run that leaves them gets a warning."""


def path_of(field: str) -> tuple[str, ...]:
    """Return the path in a scenario of a field of the robot."""
    return ("robot", *field.split("."))
