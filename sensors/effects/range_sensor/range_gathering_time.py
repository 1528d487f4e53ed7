"""Ranges of moving targets that are means over the time in which light is gathered."""

from typing import Annotated

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter


class RangeGatheringTime(Effect):
    """A reading is the mean distance over the time in which the sensor gathers light."""

    slot = Slot.RANGE_GATHERING
    cause = "light that the device gathers over its timing budget"
    excitation = "targets that jump or move fast, with readings at known times"
    # In the log of a drive, such a mean cannot be distinguished from `tof_time_offset`, a delay of half the time.
    setups = (Setup.DRIVE,)

    duration_s: Annotated[float, Parameter("s", null=0.0, start=0.03, low=0.0, high=1.0)]
    """A reading is the mean over this time before it."""

    def apply(self, duration_s: float) -> float:
        return duration_s + self.duration_s
