"""The counts of an encoder as counts that run on, whatever form its log gives them."""

from logs.counts import jump, running, unwrapped
from logs.drive import COUNTED
from logs.mapping import MAPPING, Source
from symolo.core.arrays import Array


def counted(numbers: Array, source: Source, name: str, notes: list[str]) -> Array:
    """Return the numbers of a column; those of an encoder as counts that run on.

    Args:
        numbers: (N,), as the log has them, NaN where one is missing.
        source: What the mapping says about the column.
        name: Our name of the quantity.
        notes: List that gets what was changed, and what the user has to check.
    """
    if name not in COUNTED:
        return numbers
    if source.per_row:
        return running(numbers)
    counts, wraps_at = unwrapped(numbers, source.wraps_at)
    if wraps_at:
        notes.append(f"{source.column} wraps at {wraps_at:.0f} and is continued beyond it")
    elif far := jump(counts):
        notes.append(
            f"CHECK {source.column}: it jumps by {far:.0f} from one row to the next; if its counter begins again "
            f"there, give wraps_at in {MAPPING}"
        )
    return counts
