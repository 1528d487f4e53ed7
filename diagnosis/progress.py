"""Progress of a diagnosis. It is an estimate, because how many hypotheses are fitted depends on what the fits show."""

from collections.abc import Callable, Sequence
from enum import Enum
from types import MappingProxyType


class Phase(Enum):
    """The phases of a diagnosis in their order, each with the share of the time [%] that is done when it begins."""

    SELECTION = 0
    STRUCTURE = 45
    RIVALS = 52
    TRANSFER = 60
    INTERVALS = 68
    PLOTS = 85

    @classmethod
    def at(cls, share: float) -> "Phase":
        """Return the phase in which this share is done, 0 to 1."""
        return max((phase for phase in cls if phase.value <= 100.0 * share + 1e-9), key=lambda phase: phase.value)

    @property
    def title(self) -> str:
        """Number of the phase, and what is done in it."""
        return f"step {list(Phase).index(self) + 1} of {len(Phase)}, {_TITLES[self]}"


_TITLES = MappingProxyType(
    {
        Phase.SELECTION: "selecting the effects that explain the data",
        Phase.STRUCTURE: "checking whether anything stays unexplained",
        Phase.RIVALS: "comparing each selected effect with others that could explain the same data",
        Phase.TRANSFER: "testing the effects on trials that were left out of the fit",
        Phase.INTERVALS: "computing the uncertainty of the parameters",
        Phase.PLOTS: "computing predictions, and writing plots and files",
    }
)


USUAL_ROBOTS = 200
"""Predicted robots by which a phase is half done; later ones count less, since nobody knows which one is the last."""
USUAL_ROBOTS_OF = MappingProxyType({Phase.SELECTION: 600, Phase.STRUCTURE: 20})
"""The same for phases that usually predict more or fewer. Of eight cases of all kinds, the selection predicted 180 to
2500 robots."""


SHOWN = 3
"""Hypotheses that are named while they are fitted; the others are counted."""


class DiagnosisProgress:
    """Turns phases and predicted robots into a share that grows and stays below 1.

    Args:
        on_share: Called with the share that is done, 0 to 1.
        on_fits: Called with words for what is being fitted.
    """

    def __init__(self, on_share: Callable[[float], None], on_fits: Callable[[str], None] | None = None) -> None:
        self._on_share, self._on_fits = on_share, on_fits
        self._phase = Phase.SELECTION
        self._robots = 0

    def begin(self, phase: Phase) -> None:
        """Begin a phase; the ones before it are done."""
        self._phase, self._robots = phase, 0
        if self._on_fits is not None:
            self._on_fits("")
        self._on_share(self.share)

    def predicted(self, robots: int) -> None:
        """Count robots of which all samples were predicted, which takes most of the time."""
        self._robots += robots
        self._on_share(self.share)

    def fits(self, names: Sequence[str], begun: int) -> None:
        """Note which hypotheses are still fitted, of so many that were begun together."""
        if self._on_fits is not None:
            listed = ", ".join(dict.fromkeys(names[:SHOWN])) + (", ..." if len(names) > SHOWN else "")
            self._on_fits(f"{len(names)} of {begun} models are still being fitted ({listed})")

    @property
    def share(self) -> float:
        begin = self._phase.value
        end = min((phase.value for phase in Phase if phase.value > begin), default=100)
        usual = USUAL_ROBOTS_OF.get(self._phase, USUAL_ROBOTS)
        return (begin + (end - begin) * self._robots / (self._robots + usual)) / 100


def unreported() -> DiagnosisProgress:
    """Return progress that nobody looks at."""
    return DiagnosisProgress(_ignored)


def _ignored(share: float) -> None:
    """Do nothing; unlike a lambda, it can be pickled with a diagnosis."""
