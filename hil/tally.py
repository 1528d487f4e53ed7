"""What happened on the line to the board at each control tick, in numbers: the columns of side/board.csv."""

from collections import Counter
from collections.abc import Iterable

from hil.loop import BoardEvent

COUNTED = {
    "damaged": "damaged",
    "damaged at the board": "damaged_at_board",
    "refused": "refused",
    "stale": "stale",
    "repeated": "repeated",
    "re-boot": "rebooted",
    "late": "late",
}
"""Column of each kind of event that is counted."""
COLUMNS = ("answered", "stopped", *COUNTED.values())


def tally(events: Iterable[BoardEvent], *, stopped: bool) -> tuple[int, ...]:
    """The numbers of one tick, in the order of `COLUMNS`.

    Args:
        events: Of that tick.
        stopped: Whether the wheels stand still because no command has come.
    """
    kinds = Counter(event.kind for event in events)
    return (int(not kinds["no answer"]), int(stopped), *(kinds[kind] for kind in COUNTED))
