"""Child processes on this machine: the default executor."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from typing_extensions import Self

from blender_scenes.render.devices import DeviceKind, one_card_each
from pipeline.executors.base import Executor, OnEvent
from pipeline.work.supervisor import DEFAULT_LIMITS, UnitFailure, cores, run_units
from pipeline.work.units import AnyUnit
from pipeline.work.worker_process import WorkerLimits, limits_of


@dataclass(frozen=True)
class Local(Executor):
    """Processes on this machine."""

    workers: int
    """Number of workers at a time."""
    limits: WorkerLimits = DEFAULT_LIMITS
    """Limits of each worker."""
    cards: tuple[Mapping[str, str], ...] = ()
    """Environment variables that show a worker one graphics card only, by card; workers take them in turn."""

    @classmethod
    def from_options(cls, workers: int | None, memory_gb: float | None) -> "Local":
        """Return the executor for these options; by default it uses all cores and nine tenths of the memory."""
        return cls(workers or cores(), limits_of(memory_gb))

    def on(self, device: DeviceKind) -> Self:
        return replace(self, cards=one_card_each(device, os.environ))

    def block_frames(self, frames: int, runs: int) -> int:
        """Return a size that gives every worker one block: each block costs a start of Blender."""
        blocks = -(-self.workers // runs)
        return max(1, -(-frames // blocks))

    def threads(self, units: int) -> int:
        return max(1, cores() // min(self.workers, units))

    def do(self, units: Sequence[AnyUnit], on_event: OnEvent) -> list[UnitFailure]:
        return run_units(units, self.workers, on_event, limits=self.limits, slot_environments=self.cards)
