"""A camera whose clock runs slower or faster than that of the robot."""

from collections.abc import Iterator
from typing import Annotated

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter, Plausible
from configs.validation.faults import ConfigFault
from symolo.core.arrays import Array


class PoseClockDrift(Effect):
    """The clock of the camera that logs the pose and the clock of the robot run apart at a constant rate."""

    slot = Slot.POSE_DELAY
    cause = "clocks of camera and robot that were aligned at the start only"
    excitation = "fast turns and starts, early and late in a long drive"
    setups = (Setup.DRIVE,)
    grows_with_time = True

    rate: Annotated[
        float,
        Parameter("1", null=0.0, start=0.002, low=-0.1, high=0.1),
        Plausible(-0.02, 0.02, "a clock without a quartz is off by one or two per cent"),
    ]
    """The logged pose is rate * t_s old, in addition to any constant delay, with t_s since the start of the drive."""

    def apply(self, delay_s: float | Array, time_s: float | Array) -> float | Array:
        return delay_s + self.rate * time_s

    def faults(self, *, in_simulation: bool) -> Iterator[ConfigFault]:
        if in_simulation and self.rate < 0.0:
            problem = "a simulation cannot log poses of the future"
            cure = "use a positive rate; the diagnosis of a measurement considers both signs"
            yield ConfigFault(("rate",), problem, got=self.rate, allowed="0 or more", cure=cure)
