"""Settings of splits into training, validation and test: `splits` of a scenario, and of `symolo export`."""

from typing import Annotated

from pydantic import Field, model_validator

from configs.schema.base import Fixed, FromList, Section, absent, disagreement
from symolo.dataset.documents.splits_record import SPLIT_NAMES, Grouping, SplitName, Stratum
from symolo.dataset.splits import DEFAULT_SHARES, SplitRule

_WHOLE = Fixed("it applies to the whole dataset")
Share = Annotated[float | None, _WHOLE, Field(default_factory=absent, gt=0, le=1)]
Patterns = Annotated[tuple[Annotated[str, _WHOLE], ...] | None, FromList, Field(default_factory=absent, min_length=1)]
_ROUNDING = 1e-5
"""Largest distance of the sum of the shares from 1, such as of three times 0.33333."""


class SplitShares(Section):
    """Shares of the groups in each split; their sum is 1."""

    train: Share
    """Share for training."""
    validation: Share
    """Share for the choice of a model."""
    test: Share
    """Share for the final result."""

    @property
    def by_name(self) -> dict[SplitName, float]:
        values = {"train": self.train, "validation": self.validation, "test": self.test}
        return {name: share for name in SPLIT_NAMES if (share := values[name]) is not None}


class SplitRuns(Section):
    """Names of the runs in each split, or patterns of names such as `CW/*`; each run is in one split."""

    train: Patterns
    """Runs for training."""
    validation: Patterns
    """Runs for the choice of a model."""
    test: Patterns
    """Runs for the final result."""

    @property
    def by_name(self) -> dict[SplitName, tuple[str, ...]]:
        values = {"train": self.train, "validation": self.validation, "test": self.test}
        return {name: patterns for name in SPLIT_NAMES if (patterns := values[name]) is not None}


class Splits(Section):
    """Division of the dataset: at random with `by` and `shares`, or as listed in `runs`."""

    by: Annotated[Grouping | None, _WHOLE] = Field(default_factory=absent)
    """Property by which runs are grouped; no group is divided. `image` divides runs, so that nearly equal images are in
    different splits."""
    shares: SplitShares | None = Field(default_factory=absent)
    """Share of the groups in each split; by default 0.7 for train, 0.15 for validation and 0.15 for test."""
    runs: SplitRuns | None = Field(default_factory=absent)
    """Runs of each split, in place of `by` and `shares`."""
    seed: Annotated[int | None, _WHOLE] = Field(default_factory=absent, ge=0, le=2**63 - 1)
    """Seed of the random assignment; by default that of the scenario."""

    stratify: Annotated[tuple[Annotated[Stratum, _WHOLE], ...] | None, FromList, Field(min_length=1)] = Field(
        default_factory=absent
    )
    """Properties whose values each split has in about the same proportions, such as `[route]`; no group is divided."""

    @model_validator(mode="after")
    def _complete(self) -> "Splits":
        if (self.by is None) == (self.runs is None):
            raise disagreement("", "by and runs" if self.by else "neither by nor runs", "one of by and runs")
        if self.runs is not None:
            if self.shares is not None or self.seed is not None or self.stratify is not None:
                raise disagreement("runs", "runs with shares or seed", "shares, seed and stratify only with by")
            if not self.runs.by_name:
                raise disagreement("runs", "no split", f"runs of {', '.join(SPLIT_NAMES)}")
        if self.stratify is not None and (self.by == "image" or self.by in self.stratify):
            allowed = "other properties than by, and none with by: image"
            raise disagreement("stratify", f"{', '.join(self.stratify)} with by: {self.by}", allowed)
        if self.shares is not None:
            shares = self.shares.by_name
            total = sum(shares.values())
            if abs(total - 1) > _ROUNDING:
                listed = ", ".join(f"{name} {share:g}" for name, share in shares.items()) or "none"
                raise disagreement("shares", f"{listed}: in all {total:g}", "shares whose sum is 1")
        return self

    def rule(self, seed: int) -> SplitRule:
        """Return the rule; `seed` is that of the scenario."""
        chosen = seed if self.seed is None else self.seed
        shares = self.shares.by_name if self.shares else DEFAULT_SHARES
        return SplitRule(self.by, shares, self.runs.by_name if self.runs else {}, chosen, self.stratify or ())
