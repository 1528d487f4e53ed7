"""Effects that are too weak to be named."""

from collections.abc import Iterator

from diagnosis.diagnose import Diagnosis
from diagnosis.inference.naming.verdict import NEARLY, needed_for_name
from diagnosis.inference.selection.refusal import needed


def hints(diagnosis: Diagnosis) -> Iterator[tuple[str, float, float]]:
    """Yield effects that are too weak to be named: name, fall of the cost, and the factor of rows that would decide.

    An effect that was tried several times counts with the largest fall.
    """
    entries = sorted(diagnosis.selection.refused, key=lambda entry: -entry.drop)
    largest = {entry.effect.name: entry for entry in reversed(entries)}
    for entry in diagnosis.selection.refused:
        if entry is largest[entry.effect.name] and NEARLY <= entry.drop < needed(entry.effect):
            yield entry.effect.name, entry.drop, needed_for_name(entry.effect) / entry.drop
