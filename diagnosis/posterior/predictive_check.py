"""Posterior predictive check: whether robots from the posterior would have given data like the measured ones.

Each of many robots from the posterior is simulated in the measured case, with the noise, the outliers and the rounding
of the fit. Statistics of its readings show where the measured ones lie among them (Gelman, Meng and Stern, Statistica
Sinica 6 (1996) 733-807). All of them are statistics of the differences from the prediction of the fitted robot, in its
standard deviations of the noise.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from diagnosis.diagnose import Diagnosis
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.fitting.likelihood import WIDTH
from diagnosis.measured.channel import Mask
from diagnosis.posterior.posterior import weighted_fits
from symolo.core.arrays import Array
from symolo.core.random_streams import stream

DRAWS = 100
LEVEL = 0.95
"""Share of the draws outside of which a statistic is marked."""
MIN_ROWS = 8
"""Rows from which a quantity has statistics."""
TAIL_SD = 3.0
_SIXTY_EIGHT = (0.158655, 0.841345)
"""Quantiles at one standard deviation of a normal distribution."""


def _middle(residuals: Array) -> Array:
    return np.median(residuals, axis=-1)


def _width(residuals: Array) -> Array:
    low, high = np.quantile(residuals, _SIXTY_EIGHT, axis=-1)
    return 0.5 * (high - low)


def _correlation(residuals: Array) -> Array:
    r = np.clip(residuals - _middle(residuals)[..., None], -TAIL_SD, TAIL_SD)
    return (r[..., 1:] * r[..., :-1]).sum(axis=-1) / np.maximum((r**2).sum(axis=-1), 1e-300)


def _tail(residuals: Array) -> Array:
    return (np.abs(residuals) > TAIL_SD).mean(axis=-1)


MEDIAN_NAME, WIDTH_NAME = "median", "half width of the middle 68 %"
CORRELATION_NAME, TAIL_NAME = "correlation of neighbours", "share beyond 3 sd"
STATISTICS = MappingProxyType(
    {MEDIAN_NAME: _middle, WIDTH_NAME: _width, CORRELATION_NAME: _correlation, TAIL_NAME: _tail}
)
"""Functions of residuals (..., n) in standard deviations, by their names."""


@dataclass(frozen=True)
class CheckedStatistic:
    """One statistic of the measured readings among those of the drawn robots."""

    quantity: str
    rows: str
    """`fitted` or `held out`."""
    name: str
    measured: float
    quantiles: tuple[float, float, float]
    """Lower end of the 95 % interval, median and upper end of the drawn robots."""
    share_below: float
    """Share of the drawn robots with a smaller value; equal ones count half."""

    @property
    def is_outside(self) -> bool:
        """Whether the measured value is outside the 95 % interval."""
        return not 0.5 * (1.0 - LEVEL) <= self.share_below <= 0.5 * (1.0 + LEVEL)


def predictive_check(diagnosis: Diagnosis, draws: int = DRAWS) -> tuple[CheckedStatistic, ...]:
    """Return where the measured statistics lie among those of robots from the posterior.

    Args:
        diagnosis: The diagnosis.
        draws: Number of robots.
    """
    evidence, fit = diagnosis.evidence, diagnosis.fit
    rng = stream(0, "posterior predictive check")
    middle = evidence.predicted([fit.robot]).moved(fit.whitened_change)
    sd = middle.sd[0] * fit.noise.levels[evidence.quantity]
    mean = np.concatenate([*_drawn_means(diagnosis, draws, rng)])
    replicated = mean + sd * _noise(fit, len(mean), rng)
    step = evidence.resolution
    replicated = np.where(step > 0.0, np.round(replicated / np.where(step > 0.0, step, 1.0)) * step, replicated)
    z = {"measured": (evidence.values - middle.mean[0]) / sd, "replicated": (replicated - middle.mean[0]) / sd}
    return tuple(_checked(fit, z))


def _drawn_means(diagnosis: Diagnosis, draws: int, rng: np.random.Generator) -> Iterator[Array]:
    """Yield the predictions (k, N) of the robots that were drawn from each hypothesis."""
    fits, weights = weighted_fits(diagnosis)
    counts = rng.multinomial(draws, weights)
    for fit, count in zip(fits, counts.tolist(), strict=True):
        if count:
            hypothesis, x = fit.hypothesis, _coordinates(fit, count, rng)
            yield (
                diagnosis.evidence.predicted(hypothesis.robots(x))
                .moved(diagnosis.evidence.whitened(hypothesis.local_change(x)))
                .mean
            )


def _coordinates(fit: HypothesisFit, count: int, rng: np.random.Generator) -> Array:
    """Return coordinates (count, P) from the normal distribution of a fit, within their bounds."""
    covariance = np.where(np.isfinite(fit.covariance), fit.covariance, 0.0)
    values, vectors = np.linalg.eigh(covariance)
    # The symmetric root: rounding may turn the sign of an eigenvector, which would give other draws.
    root = vectors * np.sqrt(np.maximum(values, 0.0)) @ vectors.T
    deviates = rng.standard_normal((count, len(fit.x))) @ np.asarray(root, dtype=np.float64)
    return fit.hypothesis.clipped(fit.x + deviates)


def _noise(fit: HypothesisFit, count: int, rng: np.random.Generator) -> Array:
    """Return noise (count, N) in standard deviations: correlated as in the fit, with its share of outliers."""
    evidence = fit.evidence
    noise = rng.standard_normal((count, len(evidence.values)))
    for place, observed, correlation in zip(evidence.places, evidence.observed, evidence.correlations, strict=True):
        if observed.is_series and correlation > 0.0:
            series = noise[:, place].T  # row by row: `scipy.signal` would take most of a second to load
            series[1:] *= np.sqrt(1.0 - correlation**2)
            for row in range(1, len(series)):
                series[row] += correlation * series[row - 1]
            noise[:, place] = series.T
    share, level = fit.noise.shares[evidence.quantity], fit.noise.levels[evidence.quantity]
    is_outlier = rng.random(noise.shape) < share
    return np.where(is_outlier, WIDTH * rng.standard_cauchy(noise.shape) / level, noise)


def _checked(fit: HypothesisFit, z: Mapping[str, Array]) -> Iterator[CheckedStatistic]:
    evidence = fit.evidence
    for observed, place in zip(evidence.observed, evidence.places, strict=True):
        is_reading = np.isfinite(z["measured"][place]) & np.isfinite(z["replicated"][:, place]).all(axis=0)
        if observed.is_state is not None:
            is_reading &= ~observed.is_state
        for rows, part in (("fitted", evidence.fit), ("held out", evidence.heldout)):
            inside: Mask = part[place] & is_reading
            if inside.sum() >= MIN_ROWS:
                names = [name for name in STATISTICS if observed.is_series or name != CORRELATION_NAME]
                measured, replicated = z["measured"][place][inside], z["replicated"][:, place][:, inside]
                yield from _statistics((observed.name, rows), names, measured, replicated)


def _statistics(
    label: tuple[str, str], names: Sequence[str], measured: Array, replicated: Array
) -> Iterator[CheckedStatistic]:
    for name in names:
        value, drawn = float(STATISTICS[name](measured)), STATISTICS[name](replicated)
        share = float((drawn < value).mean() + 0.5 * (drawn == value).mean())
        low, middle, high = np.quantile(drawn, (0.5 * (1.0 - LEVEL), 0.5, 0.5 * (1.0 + LEVEL))).tolist()
        yield CheckedStatistic(*label, name, value, (low, middle, high), share)
