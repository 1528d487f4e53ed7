"""How each state of the controller looks on every picture of the page, and when it was in which."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from symolo.dataset.codes import State
from symolo.dataset.rows import Ints
from symolo.pages.plotting import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION

Dash = Literal["-"] | tuple[float, tuple[float, ...]]


@dataclass(frozen=True)
class Mark:
    name: str
    """Shorter than the meaning in metadata.json."""
    colour: str
    dash: Dash
    """Of Matplotlib; pictures carry the number of the state as well, for lines that lie on each other."""


_DOTTED: Dash = (0, (1.0, 1.2))
_DASHED: Dash = (0, (4.0, 1.5))
_MIXED: Dash = (0, (5.0, 1.2, 1.0, 1.2))

MARKS: Mapping[int, Mark] = {
    State.LINE.value: Mark("line", BLACK, "-"),
    State.RIGHT_WALL.value: Mark("right wall", GREEN, "-"),
    State.LEFT_WALL.value: Mark("left wall", BLUE, _DASHED),
    State.TURN_LEFT.value: Mark("turn left", SKY, _DOTTED),
    State.TURN_RIGHT.value: Mark("turn right", PURPLE, _DOTTED),
    State.AVOID_LEFT.value: Mark("avoid by the left", ORANGE, "-"),
    State.AVOID_RIGHT.value: Mark("avoid by the right", VERMILION, _DASHED),
    State.LOST_LEFT_WALL.value: Mark("lost, left wall", GREY, _MIXED),
    State.LOST_RIGHT_WALL.value: Mark("lost, right wall", GREY, _DOTTED),
}


def named(state: int) -> str:
    """For a legend: `5 avoid by the left`."""
    return f"{state} {MARKS[state].name}"


@dataclass(frozen=True)
class Stretch:
    """Rows one after the other in the same state."""

    state: int
    first: int
    end: int
    """The row after the last."""


def stretches(state: Ints) -> tuple[Stretch, ...]:
    """All of a run in their order, each row in one of them.

    Args:
        state: (N,), at least one row.
    """
    changes = (np.flatnonzero(np.diff(state)) + 1).tolist()
    return tuple(Stretch(int(state[first]), first, end) for first, end in pairwise([0, *changes, len(state)]))
