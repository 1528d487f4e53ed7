"""Noise, outliers and missing readings, and the plan that says how much of each a case has."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.diagnosis.independent_cases.draws import log_uniform, pick
from benchmarks.diagnosis.independent_cases.recipes import Array, Mask


@dataclass
class Plan:
    """Disturbances of one case, per channel where they differ; truth.json shows them as they are."""

    noise_factor: dict[str, float]  # true standard deviation over the stated one
    outlier_share: dict[str, float]  # share of the rows
    outlier_style: str  # `alone` or `runs`
    outliers_together: bool  # whether the channels have their outliers in the same rows
    lag1: float  # lag-one correlation of the noise
    dropout_share: float  # share of the cells that are empty
    tail_degrees: int | None = None  # of freedom of Student's t, from which the noise is drawn; Gaussian without


def draw_plan(rng: np.random.Generator, channels: Sequence[str]) -> Plan:
    """Draw the disturbances of one case; every second case is exact, every second one clean."""
    exact = rng.random() < 0.5
    dirty = rng.random() < 0.5
    coloured = rng.random() < 0.3
    dropping = rng.random() < 0.5
    return Plan(
        noise_factor={c: 1.0 if exact else round(log_uniform(rng, 0.5, 2.0), 3) for c in channels},
        outlier_share={c: round(rng.uniform(0, 0.06), 4) if dirty else 0.0 for c in channels},
        outlier_style=pick(rng, ["alone", "runs"]),
        outliers_together=bool(rng.random() < 0.4),
        lag1=round(rng.uniform(0.05, 0.2), 3) if coloured else 0.0,
        dropout_share=round(rng.uniform(0.003, 0.03), 4) if dropping else 0.0,
    )


def draw_tolerance_factor(rng: np.random.Generator) -> float:
    """Draw the true spread of individuals over the stated tolerance: 1 in three of four cases, else 0.7 to 1.5."""
    return 1.0 if rng.random() < 0.75 else round(rng.uniform(0.7, 1.5), 3)


def correlated_noise(
    rng: np.random.Generator, shape: tuple[int, ...], lag1: float, tail_degrees: int | None = None
) -> Array:
    """Draw first-order autoregressive noise of unit variance along the last axis."""
    if tail_degrees is None:
        white = rng.standard_normal(shape)
    else:
        white = rng.standard_t(tail_degrees, shape) / np.sqrt(tail_degrees / (tail_degrees - 2))
    if lag1 == 0:
        return white
    noise = np.empty(shape)
    noise[..., 0] = white[..., 0]
    gain = np.sqrt(1 - lag1**2)
    for k in range(1, shape[-1]):
        noise[..., k] = lag1 * noise[..., k - 1] + gain * white[..., k]
    return noise


def whitened(values: Array, lag1: float) -> Array:
    """Take the lag-one correlation out of standardised values along the last axis."""
    later = (values[..., 1:] - lag1 * values[..., :-1]) / np.sqrt(1 - lag1**2)
    return np.concatenate([values[..., :1], later], axis=-1)


def _outlier_mask(rng: np.random.Generator, rows: int, share: float, style: str) -> Mask:
    """Draw the rows that are outliers, alone or in runs of 2 to 5, at most 6 % of all; a larger share is exact."""
    mask = np.zeros(rows, bool)
    number = min(int(rng.binomial(rows, share)), int(0.06 * rows)) if share > 0 else 0
    if share > 0.06:
        number = round(share * rows)
    while mask.sum() < number:
        length = 1 if style == "alone" else int(rng.integers(2, 6))
        start = int(rng.integers(rows))
        mask[start : start + min(length, number - int(mask.sum()))] = True
    return mask


def outlier_masks(rng: np.random.Generator, rows: int, channels: Sequence[str], plan: Plan) -> dict[str, Mask]:
    """Draw the outliers of every channel; where they come together, the largest share counts for all."""
    if not plan.outliers_together:
        return {c: _outlier_mask(rng, rows, plan.outlier_share[c], plan.outlier_style) for c in channels}
    common = _outlier_mask(rng, rows, max(plan.outlier_share[c] for c in channels), plan.outlier_style)
    return {c: common.copy() for c in channels}


def spikes(rng: np.random.Generator, sd: Array) -> Array:
    """Draw errors of outliers: 8 to 60 standard deviations to either side, in the unit of sd."""
    size = np.exp(rng.uniform(np.log(8), np.log(60), sd.shape))
    return sd * size * np.where(rng.random(sd.shape) < 0.5, -1.0, 1.0)


def dropouts(rng: np.random.Generator, rows: int, share: float) -> Mask:
    """Draw the rows whose cell is empty."""
    return rng.random(rows) < share
