"""The noise of what no source states it for, from what a model leaves.

The residual of a fitted nominal model is smoother than the channel: what a missing effect adds to it bends slowly from
row to row, and second differences take it out (`diagnosis.measured.noise`). With few rows only the level is asked for.

Where the level is stated but not for how long the noise lasts, that is found alone: the sum of the autocorrelations of
the residual less its running mean, up to the first that is nothing (Geyer, Stat. Sci. 7 (1992) 473-483), as that p of
AR(1) noise which has the same sum (1 + p)/(1 - p).
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from diagnosis.inference.evidence.evidence import Evidence, FoundNoise
from diagnosis.inference.fit import Fit
from diagnosis.measured.noise import noise_of_differences, trimmed_variance
from diagnosis.predictors.base import Observed
from symolo.core.arrays import Array

ROWS_FOR_CORRELATION = 60
MIN_ROWS = 6
CLIP = 4.0
"""Sigmas."""
RUNNING_ROWS = 61
"""Of the mean that is taken off first."""
LAGS = 12
NOTHING = 0.03
"""Autocorrelation."""
LONGEST = 0.9


def combined(evidence: Evidence, found: Mapping[str, FoundNoise]) -> Mapping[str, FoundNoise]:
    """Noises found beside some that were found before, of an evidence that has those already."""
    before = evidence.noises
    factors = {name: before[name].factor if name in before else 1.0 for name in found}
    return {name: FoundNoise(of.factor * factors[name], of.correlation) for name, of in found.items()}


def is_open(quantity: Observed) -> bool:
    """Whether something of its noise is not stated."""
    return not quantity.noise_is_stated or quantity.correlation is None


def found_noises(evidence: Evidence, fit: Fit) -> Mapping[str, FoundNoise]:
    """Of each observed quantity of whose noise something is not stated."""
    found: dict[str, FoundNoise] = {}
    for quantity, place in zip(evidence.observed, evidence.places, strict=True):
        rows = evidence.fit[place]
        if not is_open(quantity) or np.count_nonzero(rows) < MIN_ROWS:
            continue
        if quantity.noise_is_stated:
            z = np.where(rows, np.clip(fit.z[place], -CLIP, CLIP), np.nan)
            found[quantity.name] = FoundNoise(1.0, lasting(z, quantity.trial))
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


def lasting(z: Array, trial: NDArray[np.int64]) -> float:
    """Correlation of AR(1) noise that would last as long as residuals do.

    Args:
        z: (n,), residuals, NaN where there is none.
        trial: (n,), which trial a row is of; rows of different trials have nothing to do with each other.

    Returns:
        From 0 on; 0 with too few rows to tell.
    """
    if np.count_nonzero(np.isfinite(z)) < ROWS_FOR_CORRELATION:
        return 0.0
    left = np.concatenate([_without_mean(z[trial == k]) for k in np.unique(trial)])
    variance = total = float(np.nanmean(left**2))
    if variance <= 0.0:
        return 0.0
    terms = 1
    for lag in range(1, LAGS + 1):
        products = np.where(trial[lag:] == trial[:-lag], left[lag:] * left[:-lag], np.nan)
        shared = float(np.nanmean(products)) if np.isfinite(products).any() else 0.0
        if lag > 1 and shared < NOTHING * variance:
            break
        total, terms = total + 2.0 * shared, terms + 2
    # The running mean took a share of every term with it.
    total = total / (1.0 - terms / RUNNING_ROWS)
    whole = total / (variance + total / RUNNING_ROWS)
    return min(max((whole - 1.0) / (whole + 1.0), 0.0), LONGEST)


def _without_mean(z: Array) -> Array:
    """Residuals (n,) less their running mean over the rows that there are."""
    known = np.isfinite(z)
    window = np.ones(min(RUNNING_ROWS, 2 * len(z) - 1))
    total, rows = (np.convolve(of, window, mode="same") for of in (np.where(known, z, 0.0), known.astype(float)))
    return z - np.divide(total[: len(z)], rows[: len(z)], out=np.zeros_like(z), where=rows[: len(z)] > 0.5)
