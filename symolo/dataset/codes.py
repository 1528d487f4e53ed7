"""Numbers in columns that stand for names: states of the controller, statuses of a range sensor, events."""

from enum import IntEnum
from typing import Literal

BoardKind = Literal["simulated", "serial"]
FramingName = Literal["framed", "simtwo"]


class State(IntEnum):
    """State of the controller, with the numbers of data.csv (paper section 8.2)."""

    LINE = 0
    RIGHT_WALL = 1
    LEFT_WALL = 2
    TURN_LEFT = 3
    TURN_RIGHT = 4
    AVOID_LEFT = 5
    AVOID_RIGHT = 6
    LOST_LEFT_WALL = 33
    LOST_RIGHT_WALL = 44


class TofStatus(IntEnum):
    """Status of a reading of a range sensor, with the numbers of side/tof.csv."""

    VALID = 0
    NO_TARGET = 1
    HELD = 2
    """This update was lost; the value is the previous one."""


BOARD_EVENT_COLUMNS = {
    "damaged": "damaged",
    "damaged at the board": "damaged_at_board",
    "refused": "refused",
    "stale": "stale",
    "repeated": "repeated",
    "re-boot": "rebooted",
    "late": "late",
}
"""Column of side/board.csv that counts each kind of event on the line to the board."""
BOARD_COLUMNS = {
    "answered": "1 if the command of the board came in time",
    "stopped": "1 if the wheels stand still because no command came",
    "damaged": "number of frames that were damaged on the way from the board",
    "damaged_at_board": "number of frames that were damaged on the way to the board",
    "refused": "number of commands that are impossible",
    "stale": "number of answers to an older row",
    "repeated": "number of frames that were repeated",
    "rebooted": "1 if the board restarted",
    "late": "1 if the row began late",
}
"""Meaning of each column of side/board.csv after the time, the counts in the order of `BOARD_EVENT_COLUMNS`."""
