"""Whether what the best camera leaves still depends on something: functions of each covariate, by an F test.

A coarse look: polynomials of the fourth degree, Bonferroni over all covariates; a dependence that explains little of
what is left is none.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.special import fdtrc

from diagnosis.camera.fit import Fit, Model, without_own
from symolo.core.arrays import Array

LEVEL = 0.001
MIN_SHARE = 0.08
"""Of the variance of what is left."""
DEGREE = 4
CLIP = 3.0


@dataclass(frozen=True)
class Remains:
    covariate: str
    p: float
    share: float
    """Of the variance of what is left."""


def remains(model: Model, fit: Fit, covariates: Mapping[str, Array]) -> Remains | None:
    """The strongest dependence, if any."""
    left = without_own(model, model.left(fit.x), model.own(fit.x), fit.sd, fit.worth) / fit.sd
    use = np.isfinite(left) & model.fit
    z = np.clip(left[use], -CLIP, CLIP)
    found: list[Remains] = []
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
        independent = max(fit.worth * len(z), 2.0 * DEGREE)
        F = (explained / DEGREE) / ((total - explained) / (len(z) - DEGREE - 1)) * independent / len(z)
        p = min(1.0, float(fdtrc(DEGREE, independent - DEGREE - 1, F)) * len(covariates))
        found.append(Remains(name, p, explained / total))
    strongest = max(found, key=lambda of: of.share, default=None)
    return strongest if strongest and strongest.p < LEVEL and strongest.share > MIN_SHARE else None
