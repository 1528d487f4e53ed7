"""From the evidence to the verdict, by rules that cannot contradict each other.

The selection proposes names; here each of them must stand alone. A name is withheld if its number lies at a bound, if
held-out rows, a manoeuvre, a session or a range of speed contradict it, if fitted and held-out rows together show it
little more than chance does, or if another effect or an error of simple form explains the data better. What remains
decides the conclusion: a model may only be called an explanation if no test of the residuals and no effect in addition
is anywhere near significance. Between explanation and discovery lies what the data leave open.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from diagnosis.inference.fitting.hypothesis import CandidateEffect
from diagnosis.inference.selection.refusal import CLEAR, needed
from diagnosis.inference.unexplained.unlisted import BETTER
from sensors.effects.range_sensor.noise_scale import NoiseScale
from symolo.core.text_enum import TextEnum

CHEAPER = 0.5
"""Fall of the cost by which a rival explains the data better."""
MAX_BY_PRIOR = 0.5
"""Share of the rise of the cost without a name, above which it comes from parameters that leave their tolerances. Then
these may imitate the effect in held-out rows too, which therefore cannot say anything against it."""
DOUBT = 0.05
"""Probability of the strongest structure in the residuals by chance, below which a model is no explanation."""
NEARLY = 10.0
"""Fall of the cost by one more effect, from which a model is no explanation; the best of some twenty reaches it by
chance in a few cases of a hundred."""
MARGIN = 4.0
"""Fall of the cost beyond what the selection needs, from which a name stands: where tolerances and noise are not as
stated, chance reaches a little more."""
NOISY = 1.6
"""Scatter of good readings relative to the stated noise, from which a model is no explanation. The statement may be
wrong by a factor of two, but then it may as well be the model."""
MIN_WEIGHT = 0.1
"""Confidence below which a name is one of too many."""

SUBSTITUTE = "only a substitute for what is unexplained"
"""Reason of a name that is not needed beside a structure that has another cause."""


class CaseVerdict(TextEnum):
    """What a diagnosis comes to."""

    EXPLAINED = "explained"
    """The nominal simulation explains the data, and nothing suggests otherwise."""
    UNDECIDED = "undecided"
    """Nothing is certain: something may differ, but these data do not suffice to name it."""
    NAMED = "named"
    """The named effects explain the data."""
    NAMED_IN_PART = "named in part"
    """Effects are named, and structure remains that they do not explain."""
    UNEXPLAINED = "unexplained"
    """The data differ from the simulation, and no listed effect explains it."""


def margin(effect: CandidateEffect) -> float:
    """Return the fall of the cost beyond what the selection needs, from which the name of an effect stands."""
    return 0.0 if effect.kind is NoiseScale else MARGIN


def needed_for_name(effect: CandidateEffect) -> float:
    """Return the fall of the cost of fitted and held-out rows from which an effect is named."""
    return needed(effect) + margin(effect)


@dataclass(frozen=True)
class NameEvidence:
    """What the data say of one name."""

    name: str
    rise: float
    """Rise of the cost over the rows of the fit without the effect, everything else fitted again."""
    needed: float
    """Fall of the cost from which the selection accepts the effect."""
    rise_of_prior: float
    """Part of that rise from nominal parameters that leave their tolerances."""
    heldout_rise: float | None
    """Rise of the cost of the held-out rows; None if none are held out."""
    is_at_bound: bool
    """Whether one of its numbers lies at a bound of its range."""
    contradicted_by: str
    """Manoeuvre, session or range of speed that contradicts the effect when it is fitted to the rest; empty if none."""
    cancelled_by: str
    """Name of another effect of the model that undoes nearly all that this one does; empty if there is none."""
    closest_rival: tuple[str, float] | None
    """Name of the closest accepted rival and the rise of the cost with it; None if there is none."""
    ahead: float
    """Fall of the cost by which the best simple form of an error, whose cause is in no list, explains more."""
    confidence: float
    margin: float = MARGIN
    """Fall of the cost beyond what the selection needs, from which the name stands."""
    gain_at_most: float | None = None
    """Upper end of the 95 % interval of what the effect gains on the held-out rows; None if these cannot show it."""
    gain_at_least: float | None = None
    """Lower end of that interval."""
    is_far_below_a_row: bool = False
    """Whether the effect is a delay or a lag far shorter than the time between two rows."""

    @property
    def is_imitated(self) -> bool:
        """Return whether nominal parameters far off imitate the effect, as they may in held-out rows."""
        return self.rise_of_prior > MAX_BY_PRIOR * self.rise

    @property
    def heldout_rise_that_counts(self) -> float:
        """Return the rise of the cost of the held-out rows; 0 where they cannot say anything about the effect.

        Rows that nominal parameters far off predict as well or better say nothing. Rows that they predict worse do.
        """
        rise = self.heldout_rise or 0.0
        return max(rise, 0.0) if self.is_imitated else rise

    @property
    def gains_nothing(self) -> bool:
        """Return whether the held-out rows are further off with the effect, and not less likely without it."""
        if self.gain_at_most is None or self.is_imitated:
            return False
        # Unlike the error, the likelihood knows the noise of each row and leaves outliers out.
        return self.gain_at_most < 0.0 and (self.heldout_rise is None or self.heldout_rise <= 0.0)


@dataclass(frozen=True)
class WithheldName:
    """A name that the selection proposed and the verdict withholds."""

    name: str
    reason: str


def withheld(evidence: NameEvidence) -> str:
    """Return why a name is withheld; empty if it stands."""
    if evidence.is_at_bound:
        return "its size lies at the end of the possible range"
    if evidence.cancelled_by:
        return f"it and {evidence.cancelled_by} cancel each other, as if both imitate something else"
    if against := _against_by_heldout_rows(evidence):
        return against
    if evidence.contradicted_by:
        return f"it is a description and no cause: fitted to the rest, it is contradicted by {evidence.contradicted_by}"
    if evidence.closest_rival is not None and evidence.closest_rival[1] < -CHEAPER:
        return f"{evidence.closest_rival[0]} explains the data better"
    if evidence.ahead >= BETTER:
        return "an error of simple form, whose cause is in no list, explains the data better"
    # Both are differences of log-likelihoods for independent rows, so that they add up.
    rise = evidence.rise + evidence.heldout_rise_that_counts
    if rise < evidence.needed + evidence.margin:
        return f"the cost falls by {rise:.1f} only, little more than by chance"
    if evidence.confidence < MIN_WEIGHT:
        return f"its weight among the alternatives is only {100.0 * evidence.confidence:.2g} %"
    return ""


def _against_by_heldout_rows(evidence: NameEvidence) -> str:
    """Return what the held-out rows say against a name; empty if nothing."""
    if evidence.heldout_rise_that_counts < -CLEAR:
        return "the held-out rows are predicted better without it"
    if evidence.gains_nothing:
        return "the error of the held-out rows is smaller without it, over its whole 95 % interval"
    if evidence.is_far_below_a_row and evidence.gain_at_least is not None and evidence.gain_at_least <= 0.0:
        return "it is far shorter than the time between two rows, and no gain on the held-out rows is certain"
    return ""


def conclusion(
    names: Sequence[str],
    withheld_names: Sequence[WithheldName],
    *,
    is_adequate: bool,
    chance: float,
    nearly: float,
    scatter: float,
) -> CaseVerdict:
    """Return the conclusion.

    Args:
        names: Names that stand.
        withheld_names: Names that were proposed and do not.
        is_adequate: Whether the model with the names leaves no significant structure.
        chance: Probability of the strongest structure by chance, over all tests.
        nearly: Largest fall of the cost by an effect that was not accepted.
        scatter: Largest scatter of good readings relative to the stated noise.
    """
    if not is_adequate:
        return CaseVerdict.NAMED_IN_PART if names else CaseVerdict.UNEXPLAINED
    if names:
        return CaseVerdict.NAMED
    if withheld_names or chance < DOUBT or nearly >= NEARLY or scatter >= NOISY:
        return CaseVerdict.UNDECIDED
    return CaseVerdict.EXPLAINED
