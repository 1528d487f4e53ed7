"""Progress of a diagnosis. It is an estimate, because how many hypotheses are fitted depends on what the fits show."""

from collections.abc import Callable
from enum import Enum


class Phase(Enum):
    """The phases of a diagnosis in their order, each with the share of the time [%] that is done when it begins."""

    SELECTION = 0
    STRUCTURE = 40
    RIVALS = 50
    TRANSFER = 65
    INTERVALS = 80
    PLOTS = 95


USUAL_PREDICTIONS = 50
"""Predictions by which a phase is half done; later ones count less, since nobody knows which one is the last."""


class DiagnosisProgress:
    """Turns phases and predictions into a share that grows and stays below 1.

    Args:
        on_share: Called with the share that is done, 0 to 1.
    """

    def __init__(self, on_share: Callable[[float], None]) -> None:
        self._on_share = on_share
        self._phase = Phase.SELECTION
        self._predictions = 0

    def begin(self, phase: Phase) -> None:
        """Begin a phase; the ones before it are done."""
        self._phase, self._predictions = phase, 0
        self._on_share(self.share)

    def predicted(self) -> None:
        """Count a prediction of all samples."""
        self._predictions += 1
        self._on_share(self.share)

    @property
    def share(self) -> float:
        begin = self._phase.value
        end = min((phase.value for phase in Phase if phase.value > begin), default=100)
        return (begin + (end - begin) * self._predictions / (self._predictions + USUAL_PREDICTIONS)) / 100


def unreported() -> DiagnosisProgress:
    """Return progress that nobody looks at."""
    return DiagnosisProgress(_ignored)


def _ignored(share: float) -> None:
    """Do nothing; unlike a lambda, it can be pickled with a diagnosis."""
