"""How frames become bytes on the serial line: one file per framing, and this table."""

from physics.hil.framings.base import Framing
from physics.hil.framings.framed import Framed
from physics.hil.framings.simtwo import SimTwo

FRAMINGS: dict[str, Framing] = {"framed": Framed(), "simtwo": SimTwo()}
