"""Counts of what happened on the line to the board at each control tick: the columns of side/board.csv."""

from collections import Counter
from collections.abc import Iterable

from hil.loop import BoardEvent
from symolo.dataset.codes import BOARD_EVENT_COLUMNS


def tally(events: Iterable[BoardEvent], *, stopped: bool) -> tuple[int, ...]:
    """Return the counts of one tick, in the order of `BOARD_COLUMNS`.

    Args:
        events: Events of that tick.
        stopped: Whether the wheels stand still because no command has come.
    """
    kinds = Counter(event.kind for event in events)
    return (int(not kinds["no answer"]), int(stopped), *(kinds[kind] for kind in BOARD_EVENT_COLUMNS))
