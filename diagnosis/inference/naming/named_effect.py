"""An effect that the real robot has, as an answer states it."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.fitting.hypothesis import CandidateEffect
from diagnosis.inference.fitting.standard_errors import standard_errors
from diagnosis.inference.naming.file_numbers import FileNumber, file_numbers
from diagnosis.inference.naming.other_size import OtherSize
from diagnosis.inference.naming.seen_range import SeenRange, seen_ranges
from diagnosis.inference.selection.rivals import RivalComparison


@dataclass(frozen=True)
class NamedEffect:
    """One effect that the real robot has, with its parameters."""

    effect: CandidateEffect
    values: dict[str, float]
    std: dict[str, float]
    comparison: RivalComparison
    ranges: tuple[SeenRange, ...] = ()
    """Range of each covariate over the rows in which the effect was seen."""
    file_numbers: tuple[FileNumber, ...] = ()
    """Numbers that the file of the effect states, such as that of a law; empty for other effects."""
    known: Mapping[str, float] = field(default_factory=dict)
    """Numbers of the effect that no cost judges: defaults, or what they are within their tolerances in the fit."""

    other_size: OtherSize | None = None
    """Its size beside a second effect, which `std` includes; None if none would change it."""

    @classmethod
    def from_comparison(
        cls,
        evidence: Evidence,
        nominal: HypothesisFit,
        fit: HypothesisFit,
        comparison: RivalComparison,
        other: OtherSize | None = None,
    ) -> "NamedEffect":
        """Return an effect of a fit with its numbers; `nominal` is the fit without effects."""
        effect, values = comparison.effect, dict(fit.hypothesis.values(comparison.effect, fit.x))
        ranges = seen_ranges(evidence, nominal, fit, effect)
        std = standard_errors(evidence, fit, effect)
        std = std if other is None else other.wider(std)
        known = {name: getattr(fit.robot.effects.get(effect.kind), name) for name in effect.known}
        return cls(effect, values, std, comparison, ranges, file_numbers(evidence, fit, effect, std), known, other)

    @property
    def name(self) -> str:
        return self.effect.kind.name

    @property
    def seen_for(self) -> str:
        """Conditions under which the effect was seen, as text; beyond them its law is a guess."""
        return ", ".join(seen.text for seen in self.ranges)

    @property
    def parameters(self) -> dict[str, str | float]:
        """Choices and numbers of the effect."""
        return {**dict(self.effect.choices), **self.values, **self.effect.known, **self.known}
