"""The k-th of n parts of the work, for independent jobs, such as those of a Slurm array.

The part of a unit depends on the unit and on n only, not on what is done already, so nobody has to distribute units.
If two jobs do the same part, some work is done twice and nothing is harmed.
"""

import re
import zlib
from collections.abc import Sequence
from dataclasses import dataclass, replace

from typing_extensions import Self

from blender_scenes.render.devices import DeviceKind
from pipeline.executors.base import Executor, OnEvent
from pipeline.executors.local import Local
from pipeline.work.supervisor import UnitFailure
from pipeline.work.units import AnyUnit, RenderUnit
from symolo.core.errors import InputError

BLOCK_FRAMES = 50
"""Number of frames in a block: enough that the start of Blender costs little, and few enough that many machines share
a run."""
MAX_PARTS = 100_000


@dataclass(frozen=True)
class PartOfWork(Executor):
    """An executor that does every unit of one of n parts, and leaves the other parts to other jobs."""

    does_all = False

    number: int
    """Number of the part, from 1."""
    parts: int
    """Number of parts."""
    local: Local

    @classmethod
    def of_text(cls, text: str, local: Local) -> "PartOfWork":
        """Return the executor for the text `k/n`.

        Raises:
            InputError: The text has another form, or k is not in 1 to n.
        """
        match = re.fullmatch(r"(\d{1,6})/(\d{1,6})", text)
        number, parts = map(int, match.groups()) if match else (0, 0)
        if not 1 <= number <= parts <= MAX_PARTS:
            raise InputError("--part", got=text, allowed=f"k/n with 1 <= k <= n <= {MAX_PARTS}, such as 3/10")
        return cls(number, parts, local)

    def on(self, device: DeviceKind) -> Self:
        return replace(self, local=self.local.on(device))

    def block_frames(self, frames: int, runs: int) -> int:
        del frames, runs
        return BLOCK_FRAMES

    def threads(self, units: int) -> int:
        return self.local.threads(max(1, units // self.parts))

    def mine(self, unit: AnyUnit) -> bool:
        """Return whether a unit belongs to this part: the blocks of a run go to the parts in turn, and the name of
        the run decides the first one.
        """
        block = (unit.numbers[0] - 1) // BLOCK_FRAMES if isinstance(unit, RenderUnit) else 0
        return (zlib.crc32(unit.name.encode()) + block) % self.parts == self.number - 1

    def do(self, units: Sequence[AnyUnit], on_event: OnEvent) -> list[UnitFailure]:
        return self.local.do(units, on_event) if units else []
