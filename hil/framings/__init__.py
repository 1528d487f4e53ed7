"""Framings, which encode frames on the serial line: one file for each, and this table."""

from hil.framings.base import Framing
from hil.framings.framed import Framed
from hil.framings.simtwo import SimTwo

FRAMINGS: dict[str, Framing] = {"framed": Framed(), "simtwo": SimTwo()}
