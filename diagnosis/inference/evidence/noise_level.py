"""The noise of quantities whose source does not state it, estimated from the residuals of a model.

The residuals of a fitted nominal model are smoother than the channel itself: what a missing effect adds to them changes
slowly from row to row, and second differences remove it (`diagnosis.measured.noise`). With few rows only the level is
estimated.

If the source states the level but not the correlation, only the correlation is estimated: the sum of the
autocorrelations of the residuals without their running mean, up to the first that is negligible (Geyer, Stat. Sci. 7
(1992) 473-483), expressed as the p of AR(1) noise with the same sum (1 + p)/(1 - p). The rows of a sweep are no series
and have no correlation.

The noise of speeds that are computed from counts has a form of its own (`diagnosis.predictors.wheels.count_noise`), of
which the level of a random torque is estimated. The correlation is what this form leaves.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from diagnosis.inference.evidence.evidence import EstimatedNoise, Evidence
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.fitting.likelihood import LEVEL_SD
from diagnosis.measured.channel import Mask
from diagnosis.measured.noise import (
    BLOCKS,
    MIN_BLOCK_ROWS,
    jackknife_error,
    noise_of_differences,
    trimmed_variance,
    without_blocks,
)
from diagnosis.predictors.base import Observed
from diagnosis.predictors.wheels.count_noise import CountNoise
from symolo.core.arrays import Array

ROWS_FOR_CORRELATION = 60
MIN_ROWS = 6
CLIP = 4.0
"""Residual in sigmas at which it is clipped."""
RUNNING_ROWS = 61
"""Rows of the running mean that is subtracted first."""
MAX_LAG = 12
MIN_AUTOCORRELATION = 0.03
"""Autocorrelation below which the sum ends."""
MAX_CORRELATION = 0.9
NOISES = (0.5, 2.0)
"""Smallest and largest noise of a speed that is computed from counts, relative to what is stated."""
CLEAR = 3.0
"""Standard errors by which a correlation must exceed the stated one to be used in its place."""
MIN_SD = 0.4
"""Smallest standard deviation of what counts as noise, in sigmas of a fit, whose level is at most twice the true
one."""
MATERIAL_CORRELATION = 0.1
"""Excess of a correlation that matters."""
TORQUES = 24
"""Number of levels of the random torque that are tried."""


def is_open(quantity: Observed) -> bool:
    """Return whether the source does not state all of a quantity's noise."""
    return not quantity.noise_is_stated or quantity.correlation is None


def with_estimated_noises(evidence: Evidence, fit: HypothesisFit) -> Evidence:
    """Return the evidence with the noise of each quantity whose source does not state all of it, from a fit."""
    noises: dict[str, EstimatedNoise] = {}
    for k, (quantity, place) in enumerate(zip(evidence.observed, evidence.places, strict=True)):
        rows = evidence.fit[place]
        if not is_open(quantity) or np.count_nonzero(rows) < MIN_ROWS:
            continue
        # Residuals in sigmas of the noise that was estimated before, without the level that the fit found.
        z = fit.z[place] * fit.noise.levels[k]
        if quantity.count_noise is None:
            noise = _estimated(quantity, rows, z)
        else:
            residuals = quantity.count_noise.stated * evidence.unwhitened(k, z)
            noise = torque_noise(quantity.count_noise, residuals, rows, quantity.trial)
        before = evidence.noises.get(quantity.name, EstimatedNoise(1.0, 0.0))
        noises[quantity.name] = replace(
            before,
            factor=noise.factor * before.factor,
            correlation=noise.correlation,
            torque=noise.torque,
        )
    return evidence.with_noises(noises)


def with_clear_correlations(evidence: Evidence, fit: HypothesisFit) -> Evidence:
    """Return the evidence with the correlation of those series whose residuals clearly contradict the stated one.

    Rows that are more correlated than stated are worth less, and look like structure otherwise.
    """
    noises = dict(evidence.noises)
    for quantity, place, assumed in zip(evidence.observed, evidence.places, evidence.correlations, strict=True):
        if not quantity.is_series or is_open(quantity):
            continue
        z = np.where(evidence.fit[place], fit.z[place], np.nan)
        measured = correlation_of_differences(z, quantity.trial)
        # What is slower or much smaller than noise is misfit, or the rounding of a slow signal.
        is_noise = measured.correlation < MAX_CORRELATION and measured.sd > MIN_SD
        if is_noise and assumed + MATERIAL_CORRELATION < measured.correlation - CLEAR * measured.error:
            before = noises.get(quantity.name, EstimatedNoise(1.0, assumed))
            noises[quantity.name] = replace(before, correlation=measured.correlation)
    return evidence if noises == dict(evidence.noises) else evidence.with_noises(noises)


@dataclass(frozen=True)
class SuccessiveNoise:
    """AR(1) noise that has the differences of some residuals."""

    correlation: float
    """Correlation of successive rows; above 1 if the differences come from something slower than noise."""
    error: float
    """Standard error of the correlation by the jackknife, which leaves out blocks of rows; infinite with few rows."""
    sd: float
    """Standard deviation, in the unit of the residuals."""


def correlation_of_differences(z: Array, trial: NDArray[np.int64]) -> SuccessiveNoise:
    """Return the noise by the differences of residuals, to which a misfit adds little that is slow compared with it.

    Differences over two rows have 1 + p times the variance of those over one row, which is 2 (1 - p) times that of the
    noise. Outliers are trimmed.

    Args:
        z: (n,), residuals, NaN where there is none.
        trial: (n,), trial of each row.
    """
    differences = _differences(z, trial)
    if min(np.count_nonzero(np.isfinite(each)) for each in differences) < BLOCKS * MIN_BLOCK_ROWS:
        return SuccessiveNoise(0.0, np.inf, 0.0)
    without = [(_ratio(_differences(others, trial)),) for others in without_blocks(z)]
    correlation = _ratio(differences) - 1.0
    variance = trimmed_variance(differences[0]) / (2.0 * max(1.0 - correlation, 1e-3))
    return SuccessiveNoise(correlation, float(jackknife_error(without)[0]), sqrt(variance))


def _differences(z: Array, trial: NDArray[np.int64]) -> list[Array]:
    """Return the differences over one row and over two rows, NaN between trials."""
    return [np.where(trial[lag:] == trial[:-lag], z[lag:] - z[:-lag], np.nan) for lag in (1, 2)]


def _ratio(differences: Sequence[Array]) -> float:
    """Return the variance of differences over two rows, relative to that over one row."""
    near, far = map(trimmed_variance, differences)
    return far / near if near > 0.0 else 1.0


def _estimated(quantity: Observed, rows: Mask, z: Array) -> EstimatedNoise:
    """Return the noise of the residuals z (n,) in some rows (n,)."""
    if quantity.noise_is_stated:
        clipped = np.where(rows, np.clip(z, -CLIP, CLIP), np.nan)
        return EstimatedNoise(1.0, min(lasting(clipped, quantity.trial), quantity.correlation_at_most))
    z, trial = z[rows], quantity.trial[rows]
    together = np.diff(trial) == 0
    noise = noise_of_differences(z, together)
    if quantity.is_series and noise is not None and len(z) >= ROWS_FOR_CORRELATION and noise.sd > 0.0:
        return EstimatedNoise(noise.sd, max(noise.correlation, 0.0))
    bends = (z[2:] - 2.0 * z[1:-1] + z[:-2])[together[1:] & together[:-1]]
    # The variance of second differences of white noise is 1 + 4 + 1 times its own.
    level = np.sqrt(trimmed_variance(bends) / 6.0) if len(bends) else float(np.std(z))
    return EstimatedNoise(max(float(level), 1e-9), 0.0)


def torque_noise(noise: CountNoise, residuals: Array, rows: Mask, trial: NDArray[np.int64]) -> EstimatedNoise:
    """Return the level of the random torque with the largest likelihood, and the correlation that is left with it.

    Args:
        noise: The noise of speeds that are computed from counts.
        residuals: (n,), residuals of the speeds.
        rows: (n,), rows of the fit.
        trial: (n,), trial of each row.
    """
    best: tuple[float, float, Array] | None = None
    for torque in noise.torques(*NOISES, TORQUES).tolist():
        whitening = noise.whitening(torque)
        z = np.where(rows, np.clip(whitening.applied(residuals) / noise.stated, -CLIP, CLIP), np.nan)
        level = float(np.hypot(torque, np.median(noise.rounding))) / noise.stated
        costs = z**2 + 2.0 * np.log(whitening.predicted_sd / noise.stated)
        cost = float(np.nansum(costs)) + (np.log(level) / LEVEL_SD) ** 2
        if best is None or cost < best[0]:
            best = cost, torque, z
    if best is None:
        raise AssertionError("a level of the torque is tried")
    return EstimatedNoise(1.0, lasting(best[2], trial), torque=best[1])


def lasting(z: Array, trial: NDArray[np.int64]) -> float:
    """Return the correlation of AR(1) noise that lasts as long as the residuals do.

    Args:
        z: (n,), residuals, NaN where there is none.
        trial: (n,), trial of each row; rows of different trials are independent.

    Returns:
        At least 0; 0 if there are too few rows.
    """
    if np.count_nonzero(np.isfinite(z)) < ROWS_FOR_CORRELATION:
        return 0.0
    rest = np.concatenate([_without_mean(z[trial == k]) for k in np.unique(trial)])
    variance = total = float(np.nanmean(rest**2))
    if variance <= 0.0:
        return 0.0
    terms = 1
    for lag in range(1, MAX_LAG + 1):
        products = np.where(trial[lag:] == trial[:-lag], rest[lag:] * rest[:-lag], np.nan)
        shared = float(np.nanmean(products)) if np.isfinite(products).any() else 0.0
        # The first lag is counted in any case: a negative one is a property of the noise and not its end.
        if lag > 1 and shared < MIN_AUTOCORRELATION * variance:
            break
        total, terms = total + 2.0 * shared, terms + 2
    # The running mean has removed a share of every term.
    total = total / (1.0 - terms / RUNNING_ROWS)
    whole = total / (variance + total / RUNNING_ROWS)
    return min(max((whole - 1.0) / (whole + 1.0), 0.0), MAX_CORRELATION)


def _without_mean(z: Array) -> Array:
    """Return residuals (n,) without their running mean over the known rows."""
    known = np.isfinite(z)
    window = np.ones(min(RUNNING_ROWS, 2 * len(z) - 1))
    total, rows = (np.convolve(x, window, mode="same") for x in (np.where(known, z, 0.0), known.astype(float)))
    return z - np.divide(total[: len(z)], rows[: len(z)], out=np.zeros_like(z), where=rows[: len(z)] > 0.5)
