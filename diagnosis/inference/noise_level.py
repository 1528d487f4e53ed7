"""The noise of what no source states it for, from what a model leaves.

The residual of a fitted nominal model is smoother than the channel: what a missing effect adds to it bends slowly from
row to row, and second differences take it out (`diagnosis.measured.noise`). With few rows only the level is asked for.
"""

from collections.abc import Mapping

import numpy as np

from diagnosis.inference.evidence import Evidence, FoundNoise
from diagnosis.inference.fit import Fit
from diagnosis.measured.noise import noise_of_differences, trimmed_variance

ROWS_FOR_CORRELATION = 60
LEAST_ROWS = 6


def combined(evidence: Evidence, found: Mapping[str, FoundNoise]) -> Mapping[str, FoundNoise]:
    """Noises found beside some that were found before, of an evidence that has those already."""
    before = evidence.noises
    factors = {name: before[name].factor if name in before else 1.0 for name in found}
    return {name: FoundNoise(of.factor * factors[name], of.correlation) for name, of in found.items()}


def found_noises(evidence: Evidence, fit: Fit) -> Mapping[str, FoundNoise]:
    """Of each observed quantity whose noise is not stated."""
    found: dict[str, FoundNoise] = {}
    for quantity, place in zip(evidence.observed, evidence.places, strict=True):
        rows = evidence.fit[place]
        if quantity.noise_is_stated or np.count_nonzero(rows) < LEAST_ROWS:
            continue
        z, trial = fit.z[place][rows], quantity.trial[rows]
        together = np.diff(trial) == 0
        noise = noise_of_differences(z, together)
        if noise is not None and len(z) >= ROWS_FOR_CORRELATION and noise.sd > 0.0:
            found[quantity.name] = FoundNoise(noise.sd, max(noise.correlation, 0.0))
            continue
        bends = (z[2:] - 2.0 * z[1:-1] + z[:-2])[together[1:] & together[:-1]]
        level = np.sqrt(trimmed_variance(bends) / 6.0) if len(bends) else float(np.std(z))
        found[quantity.name] = FoundNoise(max(float(level), 1e-9), 0.0)
    return found
