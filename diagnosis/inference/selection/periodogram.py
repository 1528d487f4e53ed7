"""Torques that vary with the angle of a shaft: the number of cycles per turn that residuals show.

The cost has an optimum for every few hundredths of a cycle, so a fit must start at the right one. A periodogram finds
it for the price of one transform: the responses to a torque cos(n angle + phase) are linear for small torques, so the
product of residuals and responses is a Fourier transform over the angle of the residuals, filtered backwards
(Lomb-Scargle periodogram with a known response: Scargle, Astrophys. J. 263 (1982) 835-853).
"""

from dataclasses import dataclass
from math import log, pi

import numpy as np
from numpy.typing import NDArray

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.predictors.turning_response import TurningResponse
from symolo.core.arrays import Array

MAX_CYCLES = 60.0
"""Highest number of cycles per turn; the inertia of a motor smooths faster ones."""
MIN_CYCLES = 0.2
MAX_PHASE_RAD = 0.25
"""Rounding of the phases of the highest wave, by bins of the angle."""
OVERSAMPLING = 4.0
"""Frequencies for each cycle within the range of the angle."""
WAVES = 3
"""Largest number of waves that are worth a try."""
BEYOND_CHANCE = 4.0
"""Fall of the cost beyond the largest that chance gives among all frequencies, from which a wave is worth a try."""
GAINS = 24
"""Frequencies at which the sizes of responses are computed; they change slowly between them."""


@dataclass(frozen=True)
class Wave:
    """A torque amplitude cos(cycles angle + phase) against the motion."""

    cycles_per_turn: float
    phase_rad: float
    amplitude_N_m: float
    drop: float
    """Expected fall of the cost."""


def waves(evidence: Evidence, fit: HypothesisFit) -> list[Wave]:
    """Return the waves that the residuals of a fit show beyond chance, the most promising first."""
    parts = [
        (place, covariate.response)
        for observed, place in zip(evidence.observed, evidence.places, strict=True)
        for covariate in observed.covariates
        if covariate.response is not None
    ]
    span = max((float(np.ptp(response.angle_rad)) for _, response in parts), default=0.0)
    if span * MAX_CYCLES < 2.0 * pi:
        return []
    root = fit.root_weights()
    products, cycles = _products(parts, root * root * fit.z / fit.sd, span)
    coarse = np.geomspace(MIN_CYCLES, MAX_CYCLES, GAINS)
    squares = sum(response.squares(coarse) @ (root[place] / fit.sd[place]) ** 2 for place, response in parts)
    # Cosine and sine have half the squares each, and are nearly orthogonal.
    halves = np.maximum(0.5 * np.interp(cycles, coarse, squares), 1e-300)
    drops = np.abs(products) ** 2 / halves
    tops = 1 + np.flatnonzero((drops[1:-1] > drops[:-2]) & (drops[1:-1] >= drops[2:]))
    chance = 2.0 * log(max(MAX_CYCLES * span / (2.0 * pi), 1.0)) + BEYOND_CHANCE
    tops = tops[drops[tops] > chance]
    best = tops[np.argsort(-drops[tops])][:WAVES].tolist()
    return [
        Wave(float(cycles[k]), -float(np.angle(products[k])), float(np.abs(products[k]) / halves[k]), float(drops[k]))
        for k in best
    ]


def _products(
    parts: list[tuple[slice, TurningResponse]], weighted: Array, span: float
) -> tuple[NDArray[np.complex128], Array]:
    """Return the products of weighted residuals (N,) with the responses to exp(i n angle), and the cycles n, (F,)."""
    width = MAX_PHASE_RAD / MAX_CYCLES
    size = 1 << int(np.ceil(np.log2(OVERSAMPLING * span / width)))
    first = min(float(response.angle_rad.min()) for _, response in parts)
    binned = np.zeros(size)
    for place, response in parts:
        bins = np.rint((response.angle_rad - first) / width).astype(np.int64)
        binned += np.bincount(bins, response.forces(weighted[place]), size)
    cycles = 2.0 * pi / (size * width) * np.arange(size // 2 + 1)
    used = np.flatnonzero((cycles >= MIN_CYCLES) & (cycles <= MAX_CYCLES))
    transform: NDArray[np.complex128] = np.fft.rfft(binned)[used].astype(np.complex128)
    cycles = cycles[used]
    return transform.conj() * np.exp(1j * first * cycles), cycles
