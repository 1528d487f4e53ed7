"""Test whether the noise of separate readings differs between the materials, angles or temperatures of targets.

Residuals about zero may be adequate and still scatter more on one material than on others, or more at a slant or when
it is warm, which neither the stated noise nor an effect describes. The ranks of their absolute values are compared
between materials (Kruskal and Wallis, J. Am. Stat. Assoc. 47 (1952) 583) and correlated with angle and temperature
(Spearman), so that neither outliers nor a wrong level of the noise matter.
"""

from collections.abc import Iterator, Mapping

import numpy as np

from configs.effects.base import Slot
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.unexplained.adequacy import Structure
from diagnosis.predictors.base import Covariate
from symolo.core.arrays import Array

MATERIAL = "material"
"""The category that is tested. Sweeps of a motor differ in how many rows stand still, and not in their noise."""
ANGLE = "incidence_rad"
GRADUAL = (ANGLE, "temperature_C")
"""Covariates along which noise may grow. That along the distance is stated, and that in much light has an effect."""
TIMES = 1.5
"""Ratio of the noise on one material to that on the others from which it matters."""
MIN_SIZE = 0.1
"""Median size of residuals [sigma] below which they count as equal, such as on a plateau, where nothing scatters."""
AROUND = 4
"""Number of rows before and after a row, from whose median its residual is counted."""
MIN_ROWS = 4
"""Smallest number of rows of a material; those with fewer are left out."""
UNEVEN = "noise that is"
"""Beginning of what such a structure is."""


def uneven_noise(evidence: Evidence, fit: HypothesisFit) -> Iterator[Structure]:
    """Yield how the noise of each quantity that is no series differs between materials, angles and temperatures.

    Nothing is yielded for a fit with a limit, where readings do not scatter, whatever the material.
    """
    if any(effect.kind.slot is Slot.RANGE_LIMIT for effect in fit.hypothesis.effects):
        return
    covariates = [
        (number, rank, covariate)
        for number, quantity in enumerate(evidence.observed)
        for rank, covariate in enumerate(quantity.covariates)
        if covariate.name in {MATERIAL, *GRADUAL}
        and not quantity.is_series
        and np.count_nonzero(evidence.fit[evidence.places[number]]) > AROUND
    ]
    for number, rank, covariate in covariates:
        place, quantity = evidence.places[number], evidence.observed[number]
        z = np.where(evidence.fit[place], fit.z[place], np.nan)
        groups = _groups(covariate, np.abs(z))
        if len(groups) < 2 or len(np.unique(np.concatenate(list(groups.values())))) < 2:
            continue
        widest = max(groups, key=lambda label: float(np.median(groups[label])))
        times = _times(groups, widest)
        if min(times, _times(_groups(covariate, _beside_neighbours(z)), widest)) < TIMES:
            continue
        p = _probability(covariate, z, groups)
        yield Structure(
            observed=quantity.name,
            channel=quantity.channel,
            covariate=covariate.name,
            what=f"{UNEVEN} {times:.1f} times as large {widest} as in the others",
            p=min(1.0, p * len(covariates)),
            explainable=0.0,
            rank=rank,
            basis=np.zeros((len(evidence.values), 1)),
            size=0.0,
            is_over_time=False,
        )


def _probability(covariate: Covariate, z: Array, groups: Mapping[str, Array]) -> float:
    """Return the probability that noise which is the same everywhere differs at least as much."""
    from scipy.stats import kruskal, spearmanr  # noqa: PLC0415 - takes long to load, and few diagnoses come here

    if covariate.name == MATERIAL:
        return float(kruskal(*groups.values()).pvalue)
    along = _along(covariate)
    known = np.isfinite(z) & np.isfinite(along)
    _, p = np.asarray(spearmanr(along[known], np.abs(z[known]))).tolist()
    return p


def _times(groups: Mapping[str, Array], widest: str) -> float:
    """Return the median of one group over that of the others."""
    others = np.concatenate([group for label, group in groups.items() if label != widest])
    return float(np.median(groups[widest])) / max(float(np.median(others)), MIN_SIZE)


def _beside_neighbours(z: Array) -> Array:
    """Return how far residuals (n,), in the order of their rows, are from the median of those around them.

    The path of a slow drift is wide where it happens to be far from zero, and has even noise all the same.
    """
    known = np.isfinite(z)
    around = np.lib.stride_tricks.sliding_window_view(np.pad(z[known], AROUND, mode="reflect"), 2 * AROUND + 1)
    sizes = np.full(len(z), np.nan)
    sizes[known] = np.abs(z[known] - np.median(np.delete(around, AROUND, axis=1), axis=1))
    return sizes


def _groups(covariate: Covariate, sizes: Array) -> dict[str, Array]:
    """Return the sizes of the residuals on each material, or at high and at low values, with enough rows."""
    if covariate.name == MATERIAL:
        numbers, names = covariate.values, [f"in rows of the material {name}" for name in covariate.labels]
    else:
        numbers, names = _halves(_along(covariate)), [f"in rows with a {h} {covariate.name}" for h in ("low", "high")]
    groups = {}
    for number in np.unique(numbers[np.isfinite(numbers)]).tolist():
        inside = sizes[numbers == number]
        inside = inside[np.isfinite(inside)]
        if len(inside) >= MIN_ROWS:
            groups[names[int(number)]] = inside
    return groups


def _along(covariate: Covariate) -> Array:
    """Return the values (n,) along which noise may grow: an angle counts alike to both sides."""
    return np.abs(covariate.values) if covariate.name == ANGLE else covariate.values


def _halves(values: Array) -> Array:
    """Return 1 for values (n,) above their median and 0 for others, NaN where one is not known.

    If half of the rows or more have the largest value, those are the ones above.
    """
    known = np.isfinite(values)
    median = np.median(values[known]) if known.any() else np.nan
    above = values > median if np.any(values[known] > median) else values >= median
    return np.where(known, above.astype(float), np.nan)
