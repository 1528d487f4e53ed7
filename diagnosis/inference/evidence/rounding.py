"""Uncertainty of a fit because readings were rounded in the same way.

If the noise is much smaller than the step of a reading, equal true values give equal readings: a hundred readings at a
sensor's limit determine it no better than one does, to half a step. Rounding errors are independent only if the noise
dithers them, from about a third of a step on (Widrow and Kollar, Quantization Noise, 2008, ch. 19).
"""

from dataclasses import replace

import numpy as np

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit

DITHERED = 0.3
"""Noise in steps from which rounding errors are independent."""


def with_shared_rounding(evidence: Evidence, fit: HypothesisFit) -> HypothesisFit:
    """Return the fit with the covariance of rounding errors that equal readings share."""
    step = evidence.resolution
    # A rounding error is uniform over one step, with a variance of step^2/12, which `sd` includes.
    rows = np.flatnonzero(evidence.fit & (step > 0.0) & (fit.sd**2 < step**2 * (1.0 / 12.0 + DITHERED**2)))
    if not len(rows):
        return fit
    root = fit.root_weights()
    covariance = np.where(np.isfinite(fit.covariance), fit.covariance, 0.0)
    # The change of the coordinates for a change of each reading.
    pull = covariance @ (fit.slopes[:, rows] * root[rows] ** 2 / fit.sd[rows])
    _, group = np.unique(np.stack([evidence.quantity[rows], evidence.values[rows]]), axis=1, return_inverse=True)
    # Errors of one group add up before they are squared. Their independent part is already in the information.
    moved = pull * step[rows] / np.sqrt(12.0)
    together = np.stack([np.bincount(group.ravel(), weights=row) for row in moved])
    return replace(fit, shared=together @ together.T - moved @ moved.T)
