"""Sizes of the fitted robot that can be measured, each with its standard error and the nominal one."""

from collections.abc import Callable, Sequence
from math import inf, sqrt

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.diagnose import Diagnosis
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.report.sentences.quantities import with_error
from symolo.core.arrays import Array

STEP = 0.1
"""Step of a derivative, in standard errors."""

Sizes = Callable[[RobotConfig], Array]
"""Sizes (N,) of a robot."""


def sizes_text(names: Sequence[str], sizes: Sizes, unit: str, diagnosis: Diagnosis, sign: str) -> str:
    """Return the sizes of the fitted robot, each with its standard error and that of the nominal robot.

    Args:
        names: Name of each size.
        sizes: Sizes of a robot.
        unit: Unit of all sizes.
        diagnosis: The diagnosis.
        sign: Sign between a number and its standard error.
    """
    fitted, nominal = sizes(diagnosis.fit.robot).tolist(), sizes(diagnosis.nominal).tolist()
    rows = zip(names, fitted, _errors(diagnosis.fit, sizes), nominal, strict=True)
    return ", ".join(
        f"{name} {with_error(size, error, sign)} {unit} (nominal {before:.5g} {unit})"
        for name, size, error, before in rows
    )


def _errors(fit: HypothesisFit, sizes: Sizes) -> list[float]:
    """Return the standard errors of the sizes, by the covariance of all fitted numbers (the delta method)."""
    errors = np.sqrt(np.diag(fit.covariance))
    steps = np.where(np.isfinite(errors) & (errors > 0.0), STEP * errors, STEP)
    slopes = np.zeros((len(sizes(fit.robot)), len(fit.x)))
    for k, step in enumerate(steps.tolist()):
        moved = step * (np.arange(len(fit.x)) == k)
        before, after = (sizes(fit.hypothesis.robot(fit.x + sign * moved)) for sign in (-1.0, 1.0))
        slopes[:, k] = (after - before) / (2.0 * step)
    return [_error(slope, fit.covariance) for slope in slopes]


def _error(slope: Array, covariance: Array) -> float:
    """Return the standard error of a size by its slopes (P,); infinite if it depends on what is not determined."""
    matters = slope != 0.0
    covariance_of_size = covariance[np.ix_(matters, matters)]
    if not np.isfinite(covariance_of_size).all():
        return inf
    return sqrt(max(0.0, slope[matters] @ covariance_of_size @ slope[matters]))  # which rounding may bring below zero
