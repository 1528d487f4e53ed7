"""Test whether residuals scatter more than the stated noise allows, whatever they depend on.

With few rows a large misfit has no shape that a test could recognise: it looks like outliers or wide noise. If the
source states the noise, its level is evidence too. The mean of the clipped squares is compared with the chi-square
distribution, widened for some outliers among the rows and for a noise that is not known exactly. A sample of several
readings, such as a change of the pose, is an outlier as soon as one of them is.
"""

from dataclasses import replace

import numpy as np
from scipy.special import chdtrc

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.unexplained.adequacy import LEVEL, Adequacy, Structure
from diagnosis.inference.unexplained.score_test import CLIP
from diagnosis.inference.unexplained.uneven_noise import uneven_noise
from symolo.core.arrays import Array

OUTLIERS = 1.0 / 16.0
"""Share of outliers among the readings that is no structure. Squares are clipped at 9, so that their mean is 1.5 times
that of good readings: one outlier in twenty gives 1.4, a noise 10 % off 1.2."""
MIN_ROWS = 8
MANY = 0.1
"""Share of clipped residuals from which the clipped scatter is only a lower limit."""
SCATTER = "scatter of"
"""Beginning of what a structure is if it has no shape along its covariate."""


def with_scatter(evidence: Evidence, fit: HypothesisFit, result: Adequacy) -> Adequacy:
    """Return the structures of a fit with the scatters: of each quantity that scatters too much, or not evenly.

    Quantities with significant structure have none, since that makes them scatter. A scatter without shape is reported
    along the best covariate; it is not tested where the noise is not stated and was estimated from the residuals.
    """
    tested = [
        (quantity, place)
        for quantity, place in zip(evidence.observed, evidence.places, strict=True)
        if quantity.noise_is_stated and np.count_nonzero(evidence.fit[place]) >= MIN_ROWS
    ]
    scatters: list[Structure] = []
    for quantity, place in tested:
        best = next((structure for structure in result.structures if structure.observed == quantity.name), None)
        rows = evidence.fit[place]
        weight, z = evidence.weight[place][rows], fit.z[place][rows]
        independent = float(weight.sum())
        squares = float((weight * np.minimum(z**2, CLIP**2)).sum())
        # The fitted parameters use up degrees of freedom in proportion to the rows of a quantity.
        degrees = max(1.0, independent - len(fit.x) * np.count_nonzero(rows) / np.count_nonzero(evidence.fit))
        p = float(chdtrc(degrees, squares / widened(quantity.readings))) * len(tested)
        if best is not None and p < LEVEL <= best.p:
            times = np.sqrt(squares / degrees)
            scatters.append(replace(best, p=p, what=f"{SCATTER} {_times(float(times), z)}", further=()))
    # Where the mean has structure, the residuals differ in size as well.
    shapes = {name for structure in result.structures if structure.p < LEVEL for name in structure.quantities}
    uneven = [structure for structure in uneven_noise(evidence, fit) if structure.observed not in shapes]
    return Adequacy(tuple(sorted((*scatters, *uneven, *result.structures), key=lambda structure: structure.p)))


def _times(times: float, residuals: Array) -> str:
    """Return how far residuals (N,), in standard deviations of the noise, exceed it; clipped ones exceed it by more."""
    share = float(np.mean(np.abs(residuals) > CLIP))
    if share < MANY:
        return f"{times:.1f} times the stated noise"
    far = (
        f"{100.0 * share:.0f} % of the samples are off by more than {CLIP:g} standard deviations of it, at most by "
        f"{np.abs(residuals).max():.0f}"
    )
    return f"at least {times:.1f} times the stated noise ({far})"


def widened(readings: int) -> float:
    """Return the mean of the clipped squares, relative to that of good samples, where each has so many readings."""
    outliers = 1.0 - (1.0 - OUTLIERS) ** readings
    return 1.0 + (CLIP**2 - 1.0) * outliers
