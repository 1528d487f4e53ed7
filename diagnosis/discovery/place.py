"""The places where a law may act: slots of the simulator, with the covariates that their functions can see."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from configs.effects.base import Slot
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.predictors.base import Observed
from symolo.core.arrays import Array

STEP = "distance_step_m"
"""Name of the covariate with the change of the distance since the reading before."""
TIMES = ("session_time_s", "t_s")
"""Names of the covariate with the time since power-on."""
MAX_FACTOR = 0.5
"""Largest change of a factor at which a fit starts."""
MIN_SPREAD = 1e-6
"""Range of a covariate, relative to its size, up to which it is constant."""


@dataclass(frozen=True)
class SlotCovariate:
    """A quantity that the functions of a slot can see, over the rows of the fit."""

    name: str
    """Name among the covariates of the stage."""
    word: str
    """Word for it in the name of an effect."""
    words: str
    """Words for it in a sentence, with the unit."""
    unit: str
    expression: str
    """The quantity in the code of an effect."""
    values: Array
    """(n,), sorted values of the rows of the fit, none of them missing."""
    is_past: bool = False
    """Whether only forms that depend on its past may have it, since the code sees what is kept of it."""
    is_angle: bool = False
    """Whether only what repeats with each turn may depend on it."""
    is_place: bool = False
    """Whether it is a coordinate of a place in W, which may be negative, and where only edges mean anything."""
    is_of_path: bool = False
    """Whether only a jump or a drift may depend on it: the time in a drive, in which the path repeats itself, so that a
    bump or a wave in time may be a place of the room."""

    @property
    def low(self) -> float:
        return float(self.values[0])

    @property
    def high(self) -> float:
        return float(self.values[-1])

    @property
    def varies(self) -> bool:
        return len(self.values) > 0 and self.high - self.low > MIN_SPREAD * max(abs(self.low), abs(self.high))


@dataclass(frozen=True)
class LawPlace:
    """A slot, with what the code of an effect in it looks like."""

    slot: Slot
    prefix: str
    """Beginning of the names of the laws in this slot."""
    noun: str
    """What a law changes, in a sentence."""
    first: str
    """First argument of `apply`, which the law changes."""
    arguments: str
    unit: str
    size: float
    """A visible change, in the unit of the slot."""
    covariates: Mapping[str, SlotCovariate]
    imports: tuple[str, ...]
    setups: tuple[str, ...]
    is_odd: bool = False
    """Whether the law has the sign of the quantity, and its covariate is the size of it."""
    is_factor: bool = False
    """Whether the law is the change of a factor on the quantity."""
    member: str = ""
    """The only wheel, sensor or wall with the law, such as `left`; empty for all."""
    share: str = ""
    """Code of the array that is 1 for the member and 0 for others; empty for all."""
    cycles: int = 2
    """Largest number of waves per turn over an angle."""
    mean_over_turn: str = ""
    """Code of the factor by which a wave shrinks in its mean over a turn, with the number of its `cycles`."""
    may_be_constant: bool = False
    """Whether a change that depends on nothing is a law, and no listed effect."""

    @property
    def name(self) -> str:
        """Beginning of the names of the laws in this slot, with the member."""
        return f"{self.member}_{self.prefix}" if self.member else self.prefix

    def at(self, member: str, share: str, noun: str, *names: str, imports: tuple[str, ...] = ()) -> "LawPlace":
        """Return the place of one wheel, sensor or wall, with some of the covariates."""
        some = {name: self.covariates[name] for name in names if name in self.covariates}
        imports = imports or self.imports
        return replace(self, member=member, share=share, noun=noun, covariates=some, imports=imports)


VISIBLE_SIGMAS = 3.0
"""Size of a visible change, in standard deviations of the noise."""


def varying(covariates: Sequence[SlotCovariate | None]) -> dict[str, SlotCovariate]:
    """Return those covariates by name that are known and do not stay the same."""
    return {each.name: each for each in covariates if each is not None and each.varies}


def values_of(observed: Observed) -> dict[str, Array]:
    """Return the covariates of a quantity by name, (n,) each, with the coordinates of a place."""
    values = {each.name: each.values for each in observed.covariates}
    for each in observed.covariates:
        if each.second is not None:
            values |= {"x_m": each.values, "y_m": each.second}
    return values


class QuantityRead:
    """The covariates of an observed quantity, or of several that a law changes alike, such as those of both wheels."""

    def __init__(self, evidence: Evidence, *names: str, drives: bool = False) -> None:
        """Take the rows of the fit.

        Args:
            evidence: The observations.
            names: Names of the quantities.
            drives: Whether they were measured while the robot drove, so that time is a matter of its path.
        """
        self._drives = drives
        numbers = [k for k, observed in enumerate(evidence.observed) if observed.name in names]
        self._observed = [(evidence.observed[k], evidence.fit[evidence.places[k]]) for k in numbers]
        sd = np.concatenate([evidence.sd[evidence.places[k]][evidence.fit[evidence.places[k]]] for k in numbers])
        self.visible = VISIBLE_SIGMAS * float(np.median(sd)) if len(sd) else 1.0
        """A visible change of the reading."""
        sizes = np.abs(np.concatenate([observed.values[rows] for observed, rows in self._observed]))
        sizes = sizes[np.isfinite(sizes) & (sizes > 0.0)]
        self.typical = float(np.median(sizes)) if len(sizes) else 1.0
        """Median size of a reading that is not 0."""

    def time(self, expression: str) -> SlotCovariate | None:
        """Return the time since power-on, which in a log of several trials is not that since the start of a trial."""
        has_session = any("session_time_s" in values_of(observed) for observed, _ in self._observed)
        name = "session_time_s" if has_session else "t_s"
        time = self.covariate(name, "time", "time since power-on [s]", "s", expression)
        return time and replace(time, is_of_path=self._drives)

    def place(self, owner: str) -> Iterator[SlotCovariate]:
        """Yield the coordinates of the place of the robot, which are fields of an argument of a law."""
        for name in ("x", "y"):
            words = f"place of the robot along {name} [m]"
            coordinate = self.covariate(f"{name}_m", name, words, "m", f"{owner}.{name}_m")
            if coordinate is not None:
                yield replace(coordinate, is_place=True)

    def covariate(
        self,
        name: str,
        word: str,
        words: str,
        unit: str,
        expression: str,
        *,
        is_size: bool = False,
        is_past: bool = False,
        is_angle: bool = False,
    ) -> SlotCovariate | None:
        """Return a covariate over the rows of the fit; None if the quantity has none of this name."""
        every = [(values_of(observed).get(name), rows) for observed, rows in self._observed]
        parts = [values[rows & np.isfinite(values)] for values, rows in every if values is not None]
        if not parts:
            return None
        values = np.concatenate(parts)
        sizes = np.sort(np.abs(values) if is_size else values)
        return SlotCovariate(name, word, words, unit, expression, sizes, is_past, is_angle)
