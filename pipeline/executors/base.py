"""What an executor is: it does units of work somewhere, and what comes of them does not depend on where."""

from collections.abc import Callable, Sequence
from typing import Protocol

from typing_extensions import Self

from blender_scenes.render.devices import DeviceKind
from pipeline.work.supervisor import AnyEvent, UnitFailure
from pipeline.work.units import AnyUnit

OnEvent = Callable[[AnyUnit, AnyEvent], None]


class Executor(Protocol):
    """The unit is a run to simulate, or a block of one run's frames; what is durable is a run, or a frame."""

    @property
    def does_all(self) -> bool:
        """Whether it does every unit, so that afterwards nothing is left to others."""
        ...

    def check(self) -> None:
        """See that it can be reached, before anything is written.

        Raises:
            EnvironmentLacking: It cannot.
        """
        ...

    def on(self, device: DeviceKind) -> Self:
        """The same for work that renders on such a device."""
        ...

    def block_frames(self, frames: int, runs: int) -> int:
        """Frames in a block, where each of `runs` runs has `frames`."""
        ...

    def threads(self, units: int) -> int:
        """Of each renderer, where there are so many blocks."""
        ...

    def mine(self, unit: AnyUnit) -> bool:
        """Whether a unit is among those that this one does."""
        ...

    def do(self, units: Sequence[AnyUnit], on_event: OnEvent) -> list[UnitFailure]:
        """Do units that are its own, and return those that failed, as a whole or in part.

        Raises:
            EnvironmentLacking, InputError: As soon as one unit says so; it would hit every one.
            WorkerError: A bug, after the other units are done.
        """
        ...
