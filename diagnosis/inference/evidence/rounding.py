"""What readings that were all rounded alike leave open of a fit.

Where noise is much finer than the step of a reading, equal truths give equal readings: a hundred readings at a sensor's
limit say no more of it than one, half a step either way. Rounding is an error of its own for each reading only where
noise dithers it, from about a third of a step on (Widrow and Kollar, Quantization Noise, 2008, ch. 19).
"""

from dataclasses import replace

import numpy as np

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fit import Fit
from diagnosis.inference.likelihood import robust_weight

DITHERED = 0.3
"""Noise in steps, from which errors of rounding are independent."""


def with_shared_rounding(evidence: Evidence, fit: Fit) -> Fit:
    """The fit, its covariance with what samples that are rounded alike share."""
    step = evidence.resolution
    alone = evidence.fit & (step > 0.0) & (fit.sd**2 < step**2 * (1.0 / 12.0 + DITHERED**2))
    if not alone.any():
        return fit
    rows = np.flatnonzero(alone)
    root = np.where(evidence.fit, np.sqrt(evidence.weight * robust_weight(fit.z)), 0.0)
    covariance = np.where(np.isfinite(fit.covariance), fit.covariance, 0.0)
    # Change of the coordinates for a change of each reading.
    pull = covariance @ (fit.slopes[:, rows] * root[rows] ** 2 / fit.sd[rows])
    _, group = np.unique(np.stack([evidence.quantity[rows], evidence.values[rows]]), axis=1, return_inverse=True)
    moved = pull * step[rows] / np.sqrt(12.0)
    together = np.stack([np.bincount(group.ravel(), weights=of) for of in moved])
    return replace(fit, shared=together @ together.T - moved @ moved.T)
