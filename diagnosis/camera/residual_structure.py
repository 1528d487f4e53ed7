"""Test whether the residuals of the best camera still depend on a covariate, by an F test of functions of it.

The statistic and the level are those of `diagnosis.inference.unexplained.adequacy`. The functions are only polynomials
of the fourth degree, since neighbouring samples of an image share its texture: finer functions would recognise stains
of the floor. For the same reason the degrees of freedom are those of the independent samples, while a log has a known
correlation; and a dependence must explain a share of the variance, since a model of an image is never exact to its last
grey level.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from diagnosis.camera.fit import CameraFit, without_frame_effects
from diagnosis.camera.model import CameraModel
from diagnosis.inference.unexplained.adequacy import LEVEL
from diagnosis.inference.unexplained.score_test import CLIP, f_test
from symolo.core.arrays import Array

MIN_SHARE = 0.08
"""Smallest share of the variance of the residuals that a dependence explains."""
DEGREE = 4


@dataclass(frozen=True)
class RemainingStructure:
    """Dependence of the residuals on one covariate."""

    covariate: str
    p: float
    """p-value over all covariates, after Bonferroni."""
    share: float
    """Share of the variance of the residuals."""


def remaining_structure(
    model: CameraModel, fit: CameraFit, covariates: Mapping[str, Array]
) -> RemainingStructure | None:
    """Return the strongest dependence of the residuals on a covariate; None where none is significant."""
    slopes = model.frame_slopes(fit.x)
    rest = without_frame_effects(model, model.residuals(fit.x), slopes, fit.sd, fit.independent_share) / fit.sd
    use = np.isfinite(rest) & model.fit
    z = np.clip(rest[use], -CLIP, CLIP)
    if len(z) < 10 * DEGREE:
        return None
    independent = max(fit.independent_share * len(z), 2.0 * DEGREE)
    structures: list[RemainingStructure] = []
    for name, values in covariates.items():
        x = values[use]
        spread = float(np.ptp(x))
        if spread == 0:
            continue
        columns = np.polynomial.legendre.legvander(2.0 * (x - x.min()) / spread - 1.0, DEGREE)
        basis = np.linalg.qr(columns)[0]
        centred = z - z.mean()
        explained = float(((basis.T @ centred) ** 2).sum())
        total = float(centred @ centred)
        # As in the test of a log, the explained squares count only for the independent samples.
        level = (total - explained) / (len(z) - DEGREE - 1) * len(z) / independent
        p = min(1.0, f_test(explained, level, DEGREE, independent - DEGREE - 1) * len(covariates))
        structures.append(RemainingStructure(name, p, explained / total))
    strongest = max(structures, key=lambda structure: structure.share, default=None)
    return strongest if strongest and strongest.p < LEVEL and strongest.share > MIN_SHARE else None
