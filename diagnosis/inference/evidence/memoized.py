"""Memoization: functions of an evidence that run once for the same arguments.

Swaps, removals and the search for rivals fit many of the same hypotheses from the same starts.
"""

from collections.abc import Callable
from functools import wraps
from typing import TypeVar, TypeVarTuple

from diagnosis.inference.evidence.evidence import Evidence

Arguments = TypeVarTuple("Arguments")
Result = TypeVar("Result")


def memoized(function: Callable[[Evidence, *Arguments], Result]) -> Callable[[Evidence, *Arguments], Result]:
    """Decorate a function so that it runs once for each evidence and arguments, which are positional and hashable."""

    # functools.cache would keep every evidence alive; here the results go with their evidence.
    @wraps(function)
    def memoizing(evidence: Evidence, *args: *Arguments) -> Result:
        key = (function, *args)
        if key not in evidence.memo:
            evidence.memo[key] = function(evidence, *args)
        return evidence.memo[key]  # pyright: ignore[reportReturnType]

    return memoizing
