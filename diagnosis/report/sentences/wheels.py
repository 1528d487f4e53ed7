"""The wheels of the fitted robot in numbers that can be measured: both diameters and the track, in millimetres."""

from math import inf, sqrt

import numpy as np

from configs.effects.base import Slot
from configs.schema.robot import RobotConfig
from diagnosis.diagnose import Diagnosis
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.naming.named_effect import NamedEffect
from diagnosis.report.sentences.quantities import with_error
from physics.robot.model import RobotModel
from symolo.core.arrays import Array

STEP = 0.1
"""Step of a derivative, in standard errors."""


def wheel_sizes(named: NamedEffect, diagnosis: Diagnosis, sign: str = "±") -> str:
    """Return both diameters and the track of the fitted robot, each with the nominal one; empty for other effects.

    Args:
        named: An effect that is named; only those of the geometry change these sizes.
        diagnosis: The diagnosis.
        sign: Sign between a number and its standard error.
    """
    if named.effect.kind.slot is not Slot.GEOMETRY:
        return ""
    names = ("left diameter", "right diameter", "track")
    fitted, nominal = _sizes_mm(diagnosis.fit.robot).tolist(), _sizes_mm(diagnosis.nominal).tolist()
    sizes = zip(names, fitted, _errors_mm(diagnosis.fit), nominal, strict=True)
    return ", ".join(
        f"{name} {with_error(size, error, sign)} mm (nominal {before:.5g} mm)" for name, size, error, before in sizes
    )


def _sizes_mm(robot: RobotConfig) -> Array:
    """Return the diameters of the left and the right wheel, and the track."""
    geometry = RobotModel.from_config(robot).geometry
    return 1e3 * np.array([2.0 * geometry.left_radius_m, 2.0 * geometry.right_radius_m, geometry.track_m])


def _errors_mm(fit: HypothesisFit) -> list[float]:
    """Return the standard errors of the sizes, by the covariance of all fitted numbers (the delta method)."""
    errors = np.sqrt(np.diag(fit.covariance))
    steps = np.where(np.isfinite(errors) & (errors > 0.0), STEP * errors, STEP)
    slopes = np.zeros((3, len(fit.x)))
    for k, step in enumerate(steps.tolist()):
        moved = step * (np.arange(len(fit.x)) == k)
        before, after = (_sizes_mm(fit.hypothesis.robot(fit.x + sign * moved)) for sign in (-1.0, 1.0))
        slopes[:, k] = (after - before) / (2.0 * step)
    return [_error(slope, fit.covariance) for slope in slopes]


def _error(slope: Array, covariance: Array) -> float:
    """Return the standard error of a size by its slopes (P,); infinite if it depends on what is not determined."""
    matters = slope != 0.0
    of_size = covariance[np.ix_(matters, matters)]
    if not np.isfinite(of_size).all():
        return inf
    return sqrt(max(0.0, slope[matters] @ of_size @ slope[matters]))  # which rounding may bring below zero
