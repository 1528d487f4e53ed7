"""The ranges in which the effects of a robot were observed."""

from typing import Annotated, Literal

from pydantic import Field, model_validator
from typing_extensions import Self

from configs.schema.base import Fixed, Section, Slug, disagreement

Observation = Annotated[float, Field(ge=-1e6, le=1e6), Fixed("it was observed, not chosen")]


class EffectRange(Section):
    """Range of one quantity in which an effect was observed. A run that leaves the range gets a warning."""

    effect: Slug
    """Name of the effect."""
    quantity: Literal["v_m_s", "w_rad_s", "wheel_speed_rad_s", "voltage_V", "current_A", "tof_m"]
    """Speed or yaw rate of the robot, speed, voltage or current of a wheel, or reading of a range sensor."""
    low: Observation
    """Smallest value at which the effect was observed, in the unit at the end of the quantity's name."""
    high: Observation
    """Largest value at which the effect was observed."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.low > self.high:
            raise disagreement("low", self.low, f"at most high, which is {self.high:g}")
        return self
