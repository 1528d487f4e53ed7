"""The samples in which a law acts.

A law of a place acts only where the robot came there, which may be in no held-out sample.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.discovery.place import values_of
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.naming.seen_range import SeenRange
from diagnosis.measured.channel import Mask


@dataclass(frozen=True)
class ActiveSamples:
    """Samples in which a law changes a prediction notably, of the quantity in which it does so most often."""

    fitted: int
    all_fitted: int
    """Number of all fitted samples, whether the law acts there or not."""
    heldout: int
    all_heldout: int
    """Number of all held-out samples."""
    ranges: tuple[SeenRange, ...]
    """Range of each covariate of the law over the samples in which it acts."""

    @classmethod
    def from_evidence(cls, evidence: Evidence, covariates: Sequence[str], acts: Mask) -> "ActiveSamples | None":
        """Return the samples in which a law acts; None if it acts in none.

        Args:
            evidence: The observations.
            covariates: Those of the law.
            acts: (N,), whether the law matters, as of `seen_range.rows_of`.
        """
        counts = [np.count_nonzero(acts[place]) for place in evidence.places]
        if not any(counts):
            return None
        largest = int(np.argmax(counts))
        place, values = evidence.places[largest], values_of(evidence.observed[largest])
        here, fitted, heldout = acts[place], evidence.fit[place], evidence.heldout[place]
        ranges = []
        for name in covariates:
            inside = values[name][here & np.isfinite(values[name])] if name in values else np.zeros(0)
            if len(inside):
                ranges.append(SeenRange(name, float(inside.min()), float(inside.max())))
        return cls(
            fitted=np.count_nonzero(fitted & here),
            all_fitted=np.count_nonzero(fitted),
            heldout=np.count_nonzero(heldout & here),
            all_heldout=np.count_nonzero(heldout),
            ranges=tuple(ranges),
        )

    @property
    def is_everywhere(self) -> bool:
        return (self.fitted, self.heldout) == (self.all_fitted, self.all_heldout)

    @property
    def misses_heldout(self) -> bool:
        """Whether samples are held out, and the law acts in none of them."""
        return self.all_heldout > 0 and self.heldout == 0

    @property
    def text(self) -> str:
        """Return how many these are and their ranges, as in `31 of 90 fitted samples: x_m from 0.6 to 1`."""
        text = f"{self.fitted} of {self.all_fitted} fitted samples"
        if self.all_heldout:
            text += f" and {self.heldout or 'none'} of {self.all_heldout} held-out ones"
        ranges = ", ".join(seen.text for seen in self.ranges)
        return f"{text}: {ranges}" if ranges else text
