"""What was worked out of an evidence once, kept for whoever asks again.

Swaps, removals and the search for rivals fit many of the same hypotheses from the same starts.
"""

from collections.abc import Callable
from functools import wraps
from typing import TypeVar, TypeVarTuple

from diagnosis.inference.evidence.evidence import Evidence

Asked = TypeVarTuple("Asked")
Found = TypeVar("Found")


def remembered(
    function: Callable[[Evidence, *Asked], Found],
) -> Callable[[Evidence, *Asked], Found]:
    """The function, worked out once for each evidence and arguments; these are to be hashable, and by position."""

    @wraps(function)
    def asked(evidence: Evidence, *args: *Asked) -> Found:
        key = (function, *args)
        if key not in evidence.known:
            evidence.known[key] = function(evidence, *args)
        return evidence.known[key]  # pyright: ignore[reportReturnType]

    return asked
