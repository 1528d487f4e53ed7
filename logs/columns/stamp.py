"""Times that a column of whole seconds and one of parts of a second give together."""

from collections.abc import Collection

import numpy as np

from logs.columns.combined import stamp_columns
from logs.log_file import LogFile
from logs.mapping import Source


def stamp_source(log: LogFile, column: str, fillers: Collection[str]) -> Source | None:
    """Return the time of a column of seconds with the parts of one beside it; None if the column is a whole time.

    Seconds with decimals are a whole time. Microseconds beside them are something else, such as a counter that runs on.

    Args:
        log: The log.
        column: Column of the times.
        fillers: Words that may stand in a name.

    Raises:
        InputError: A cell of the seconds is no number, or empty.
    """
    stamp = stamp_columns([*log.columns], fillers)
    if column != stamp.get("column") or np.any(log.times(column) % 1.0):
        return None
    return Source.model_validate(stamp)
