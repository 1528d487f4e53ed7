"""Child processes of this one, on this machine: the default."""

from collections.abc import Sequence
from dataclasses import dataclass

from pipeline.executors.base import OnEvent
from pipeline.units import AnyUnit
from pipeline.worker_process import Limits, limits_of
from pipeline.workers import BY_LIMITS, UnitFailure, cores, run_units


@dataclass(frozen=True)
class Local:
    workers: int
    """At a time."""
    limits: Limits = BY_LIMITS
    """Of each worker."""

    @classmethod
    def of(cls, workers: int | None, memory_gb: float | None) -> "Local":
        """As options say it: all cores, and what keeps the machine from running out of memory, by default."""
        return cls(workers or cores(), limits_of(memory_gb))

    @property
    def does_all(self) -> bool:
        return True

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
        return run_units(units, self.workers, on_event, limits=self.limits)
