"""Child processes of this one, on this machine: the default."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from typing_extensions import Self

from blender_scenes.render.devices import DeviceKind, one_card_each
from pipeline.executors.base import OnEvent
from pipeline.work.supervisor import DEFAULT_LIMITS, UnitFailure, cores, run_units
from pipeline.work.units import AnyUnit
from pipeline.work.worker_process import Limits, limits_of


@dataclass(frozen=True)
class Local:
    workers: int
    """At a time."""
    limits: Limits = DEFAULT_LIMITS
    """Of each worker."""
    cards: tuple[Mapping[str, str], ...] = ()
    """Variables for each graphics card with which a worker sees that one alone; workers take them in turn."""

    @classmethod
    def of(cls, workers: int | None, memory_gb: float | None) -> "Local":
        """As options say it: all cores, and what keeps the machine from running out of memory, by default."""
        return cls(workers or cores(), limits_of(memory_gb))

    @property
    def does_all(self) -> bool:
        return True

    def check(self) -> None:
        """It is this machine."""

    def on(self, device: DeviceKind) -> Self:
        return replace(self, cards=one_card_each(device, os.environ))

    def block_frames(self, frames: int, runs: int) -> int:
        """As many blocks for each run as it takes to give every worker one: each costs a start of Blender."""
        blocks = -(-self.workers // runs)
        return max(1, -(-frames // blocks))

    def threads(self, units: int) -> int:
        return max(1, cores() // min(self.workers, units))

    def mine(self, unit: AnyUnit) -> bool:
        del unit
        return True

    def do(self, units: Sequence[AnyUnit], on_event: OnEvent) -> list[UnitFailure]:
        return run_units(units, self.workers, on_event, limits=self.limits, slot_environments=self.cards)
