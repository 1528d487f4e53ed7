"""Measured cases with hidden effects, made by an oracle that shares no code with what is tested.

`make_case` draws a bench, the individual robot and what is wrong with it, and its data; `judge` says what can be known
from them; `write` puts them into the files of the format.
"""

from .beyond import BEYOND
from .beyond_wide import WIDE_BEYOND
from .case import Case, Effect, Outside, World
from .disturbances import FAMILIES, Day, Outliers
from .files import write
from .judge import DETECTABLE, NAMELESS, Verdict, judge
from .make import KINDS, draw_bench, draw_effect, draw_outside, make_case, outside_names
from .sizes import SIZES, names

__all__ = [
    "BEYOND",
    "DETECTABLE",
    "FAMILIES",
    "KINDS",
    "NAMELESS",
    "SIZES",
    "WIDE_BEYOND",
    "Case",
    "Day",
    "Effect",
    "Outliers",
    "Outside",
    "Verdict",
    "World",
    "draw_bench",
    "draw_effect",
    "draw_outside",
    "judge",
    "make_case",
    "names",
    "outside_names",
    "write",
]
