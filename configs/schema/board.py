"""A micro-controller board that drives the robot in place of the built-in controller (paper section 7)."""

from typing import Annotated

from pydantic import Field

from configs.schema.base import Fixed, Section
from symolo.dataset.codes import BoardKind, FramingName

_BOARD_SETTING = Fixed("it belongs to the board, not to the robot")


class Board(Section):
    """Hardware in the loop: the simulator provides sensors and motors, the board controls."""

    kind: Annotated[BoardKind, _BOARD_SETTING] = "simulated"
    """`simulated` is an ATmega2560 inside the program, in lock-step with the simulation and reproducible; `serial` is a
    real board at a port, in real time, which only `symolo hil --port` uses."""
    framing: Annotated[FramingName, _BOARD_SETTING] = "framed"
    """Format of messages: `framed` with sequence number and CRC-16, or the channels of SimTwo."""
    baud: Annotated[int | None, _BOARD_SETTING] = Field(default=None, ge=1200, le=2_000_000)
    """Baud rate; by default 500000 for `framed` and 115200 for `simtwo`."""
    actuation_delay_ticks: int = Field(default=1, ge=0, le=20)
    """Delay in control ticks between readings and the effect of their command; 1 in SimTwo."""
    timeout_ticks: int = Field(default=3, ge=1, le=100)
    """Number of control ticks without a command after which the wheels are stopped."""
    give_up_s: float = Field(default=2.0, ge=0.1, le=3600.0)
    """Time without a command after which the run fails."""

    @property
    def bits_per_s(self) -> int:
        return self.baud or {"framed": 500_000, "simtwo": 115_200}[self.framing]
