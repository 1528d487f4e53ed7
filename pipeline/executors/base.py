"""The interface of executors: each does units of work somewhere, and the results do not depend on where."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import ClassVar

from typing_extensions import Self

from blender_scenes.render.devices import DeviceKind
from pipeline.work.supervisor import AnyEvent, UnitFailure
from pipeline.work.units import AnyUnit

OnEvent = Callable[[AnyUnit, AnyEvent], None]


class Executor(ABC):
    """Does units: runs to simulate and blocks of frames. Finished runs and finished frames survive an interruption."""

    does_all: ClassVar[bool] = True
    """Whether it does every unit; otherwise other processes do the rest."""

    def check(self) -> None:  # noqa: B027 - this machine can always be reached
        """Check that the executor can be reached, before anything is written.

        Raises:
            EnvironmentLacking: It cannot be reached.
        """

    def mine(self, unit: AnyUnit) -> bool:
        """Return whether this executor does a unit."""
        del unit
        return True

    @abstractmethod
    def on(self, device: DeviceKind) -> Self:
        """Return the same executor for rendering on such a device."""

    @abstractmethod
    def block_frames(self, frames: int, runs: int) -> int:
        """Return the number of frames in a block when each of `runs` runs has `frames`."""

    @abstractmethod
    def threads(self, units: int) -> int:
        """Return the number of threads of each renderer for that number of blocks."""

    @abstractmethod
    def do(self, units: Sequence[AnyUnit], on_event: OnEvent) -> list[UnitFailure]:
        """Do units and return those that failed, as a whole or in part.

        Raises:
            EnvironmentLacking, InputError: As soon as one unit reports it, because it would hit every unit.
            WorkerError: A bug, after the other units are done.
        """
