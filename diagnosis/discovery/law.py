"""A law that a diagnosis discovered: its form with the fitted numbers, its evidence, and its effect file."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from textwrap import wrap

from configs.effects.registry import EFFECTS
from diagnosis.discovery.active_samples import ActiveSamples
from diagnosis.discovery.form import LawForm
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.fitting.hypothesis import CandidateEffect
from diagnosis.inference.gain import Gain
from diagnosis.inference.naming.seen_range import SeenRange
from diagnosis.inference.unexplained.adequacy import Structure

WIDTH = 110
"""Width of the notes in the file."""


@dataclass(frozen=True)
class DiscoveredLaw:
    """A law, which describes what no listed effect explains."""

    form: LawForm
    """Form of the law, whose numbers start at the fitted values."""
    without: HypothesisFit
    """The fit with the named effects and without the law."""
    values: Mapping[str, float]
    std: Mapping[str, float]
    ranges: tuple[SeenRange, ...]
    """Range of each of its own covariates over all rows, and of the others over the rows in which it matters."""
    active: ActiveSamples | None
    """Samples in which it acts; None if it matters in none by itself."""
    is_curve: bool
    """Whether it is a smooth curve, since no form with few numbers was as good."""
    fall: float
    """Fall of the cost of the rows of the fit by the law."""
    heldout_fall: float | None
    """Fall of the cost of the held-out rows; None if none are held out."""
    gain: Gain | None
    """Gain on held-out rows over the model without the law; None if none are held out."""
    chance: float
    """Share of draws of signs of the residuals in which some form did as well."""
    forms_tried: int
    rivals: tuple[tuple[str, float], ...]
    """Other forms that do nearly as well, in words, and by how much the cost is higher."""
    left: Structure | None
    """The structure that remains beside the law; None if there is none."""
    source: str
    """Name of the case."""

    @property
    def effect(self) -> CandidateEffect:
        return self.form.candidate

    @property
    def name(self) -> str:
        """Name of the effect."""
        return self.effect.kind.name

    @property
    def file(self) -> str:
        """Name of its effect file."""
        return f"{self.name}.py"

    @property
    def seen_for(self) -> str:
        """Conditions under which the law was seen, as text."""
        return ", ".join(seen.text for seen in self.ranges)

    @cached_property
    def text(self) -> str:
        """Text of the effect file."""
        notes = [
            f"`symolo diagnose --discover` proposed it for {self.source}. It describes the data and names no cause."
        ]
        notes += [f"It acts in {self.active.text}."] if self.active and not self.active.is_everywhere else []
        notes += [f"Seen for {self.seen_for}."] if self.ranges else []
        if self.gain is not None:
            notes.append(f"Gain on held-out rows: {100.0 * self.gain.value:.3g} %.")
        notes += [f"Nearly as good: {words}." for words, _ in self.rivals]
        return self.form.with_errors(self.std).text([line for note in notes for line in wrap(note, WIDTH)])

    @contextmanager
    def registered(self) -> Iterator[None]:
        """Have the law among the effects, as if its file were loaded, until the context ends."""
        with EFFECTS.holding(self.effect.kind, Path(self.file).absolute(), self.text.encode()):
            yield


@dataclass(frozen=True)
class Discovery:
    """Result of the search for a law."""

    law: DiscoveredLaw | None
    reason: str
    """Why there is no law; empty if there is one."""
