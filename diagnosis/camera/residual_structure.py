"""Test whether the residuals of the best camera still depend on a covariate, by an F test of functions of it.

A coarse look: polynomials of the fourth degree, Bonferroni over all covariates; a dependence that explains little of
what is left is none.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.special import fdtrc

from diagnosis.camera.fit import CameraFit, CameraModel, without_frame_effects
from symolo.core.arrays import Array

LEVEL = 0.001
MIN_SHARE = 0.08
"""Share of the variance of the residuals."""
DEGREE = 4
CLIP = 3.0


@dataclass(frozen=True)
class RemainingStructure:
    covariate: str
    p: float
    share: float
    """Share of the variance of the residuals."""


def remaining_structure(
    model: CameraModel, fit: CameraFit, covariates: Mapping[str, Array]
) -> RemainingStructure | None:
    """Return the strongest dependence of the residuals on a covariate; None where none is significant."""
    left = (
        without_frame_effects(model, model.residuals(fit.x), model.frame_slopes(fit.x), fit.sd, fit.independent_share)
        / fit.sd
    )
    use = np.isfinite(left) & model.fit
    z = np.clip(left[use], -CLIP, CLIP)
    found: list[RemainingStructure] = []
    for name, values in covariates.items():
        x = values[use]
        spread = float(np.ptp(x))
        if len(z) < 10 * DEGREE or spread == 0:
            continue
        columns = np.polynomial.legendre.legvander(2.0 * (x - x.min()) / spread - 1.0, DEGREE)
        basis = np.linalg.qr(columns)[0]
        centred = z - z.mean()
        explained = float(((basis.T @ centred) ** 2).sum())
        total = float(centred @ centred)
        independent = max(fit.independent_share * len(z), 2.0 * DEGREE)
        F = (explained / DEGREE) / ((total - explained) / (len(z) - DEGREE - 1)) * independent / len(z)
        p = min(1.0, float(fdtrc(DEGREE, independent - DEGREE - 1, F)) * len(covariates))
        found.append(RemainingStructure(name, p, explained / total))
    strongest = max(found, key=lambda of: of.share, default=None)
    return strongest if strongest and strongest.p < LEVEL and strongest.share > MIN_SHARE else None
