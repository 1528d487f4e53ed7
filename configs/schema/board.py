"""A micro-controller board that drives the robot in place of the built-in controller (paper section 7)."""

from typing import Annotated

from pydantic import Field

from configs.schema.base import Fixed, Section
from symolo.dataset.codes import BoardKind, FramingName

_ITS_OWN = Fixed("it belongs to the board, not to the robot")


class Board(Section):
    """Hardware in the loop: the simulator plays sensors and motors, the board decides."""

    kind: Annotated[BoardKind, _ITS_OWN] = "simulated"
    """`simulated` is an ATmega2560 within the program, in lock-step with the simulation and the same every time;
    `serial` a real one at a port, in real time, which only `symolo hil --port` reaches."""
    framing: Annotated[FramingName, _ITS_OWN] = "framed"
    """How the bytes are put together: `framed` with sequence number and CRC-16, or SimTwo's channels."""
    baud: Annotated[int | None, _ITS_OWN] = Field(default=None, ge=1200, le=2_000_000)
    """500000 for `framed` and 115200 for `simtwo` unless it is said."""
    actuation_delay_ticks: int = Field(default=1, ge=0, le=20)
    """By how many control ticks a command acts later than the readings that it answers; 1 in SimTwo."""
    timeout_ticks: int = Field(default=3, ge=1, le=100)
    """After so many control ticks without a command the wheels are told to stand still."""
    give_up_s: float = Field(default=2.0, ge=0.1, le=3600.0)
    """After so long without a command the run ends as failed."""

    @property
    def bits_per_s(self) -> int:
        return self.baud or {"framed": 500_000, "simtwo": 115_200}[self.framing]
