"""Measured cases with hidden effects, made by an oracle that shares no code with what is tested.

`make_case` draws a bench, the individual robot and what is wrong with it, and its data; `judge` says what can be known
from them; `write` puts them into the files of the format.
"""

from .beyond import BEYOND
from .case import Case, Effect, Outside, World
from .files import write
from .judge import DETECTABLE, NAMELESS, Verdict, judge
from .make import KINDS, draw_bench, draw_effect, draw_outside, make_case
from .sizes import SIZES, names

__all__ = [
    "BEYOND",
    "DETECTABLE",
    "KINDS",
    "NAMELESS",
    "SIZES",
    "Case",
    "Effect",
    "Outside",
    "Verdict",
    "World",
    "draw_bench",
    "draw_effect",
    "draw_outside",
    "judge",
    "make_case",
    "names",
    "write",
]
