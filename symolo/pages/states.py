"""Colours of the controller's states in the plots, and the stretches of a run in one state."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from symolo.dataset.codes import State
from symolo.dataset.tables.rows import NO_STATE, Ints
from symolo.pages.plotting import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION

Dash = Literal["-"] | tuple[float, tuple[float, ...]]


@dataclass(frozen=True)
class StateStyle:
    """Name, colour and dashes of a state in the plots."""

    name: str
    """Name of the state, shorter than the meaning in metadata.json."""
    colour: str
    dash: Dash
    """Dash pattern of Matplotlib. Plots show the number of the state as well, since lines may cover each other."""


_DOTTED: Dash = (0, (1.0, 1.2))
_DASHED: Dash = (0, (4.0, 1.5))
_MIXED: Dash = (0, (5.0, 1.2, 1.0, 1.2))

STATE_STYLES: Mapping[int, StateStyle] = {
    State.LINE.value: StateStyle("line", BLACK, "-"),
    State.RIGHT_WALL.value: StateStyle("right wall", GREEN, "-"),
    State.LEFT_WALL.value: StateStyle("left wall", BLUE, _DASHED),
    State.TURN_LEFT.value: StateStyle("turn left", SKY, _DOTTED),
    State.TURN_RIGHT.value: StateStyle("turn right", PURPLE, _DOTTED),
    State.AVOID_LEFT.value: StateStyle("avoid by the left", ORANGE, "-"),
    State.AVOID_RIGHT.value: StateStyle("avoid by the right", VERMILION, _DASHED),
    State.LOST_LEFT_WALL.value: StateStyle("lost, left wall", GREY, _MIXED),
    State.LOST_RIGHT_WALL.value: StateStyle("lost, right wall", GREY, _DOTTED),
    NO_STATE: StateStyle("path", BLUE, "-"),
}


def named(state: int) -> str:
    """Return the name for a legend, such as `5 avoid by the left`."""
    return STATE_STYLES[state].name if state == NO_STATE else f"{state} {STATE_STYLES[state].name}"


@dataclass(frozen=True)
class Stretch:
    """Successive rows in the same state."""

    state: int
    first: int
    end: int
    """Index of the row after the last one."""


def stretches(state: Ints) -> tuple[Stretch, ...]:
    """Return the stretches of a run in their order; each row is in one of them.

    Args:
        state: (N,), at least one row.
    """
    changes = (np.flatnonzero(np.diff(state)) + 1).tolist()
    return tuple(Stretch(int(state[first]), first, end) for first, end in pairwise([0, *changes, len(state)]))
