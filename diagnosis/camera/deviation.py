"""A deviation as what a user calls it: a difference from the nominal camera, a factor, or the value itself."""

from math import exp, sqrt

from diagnosis.camera.case import PictureCase
from diagnosis.camera.parameter import Number


def found_value(number: Number, x: float, sd: float, case: PictureCase) -> tuple[float, float]:
    """Value and standard error in the number's unit, of a deviation and its standard error in tolerances."""
    deviation, error = x * number.tolerance, sd * number.tolerance
    if number.name.endswith("_scale"):
        return exp(deviation), exp(deviation) * error
    if number.name in SQUARED:
        nominal = nominal_root(number, case)
        root = sqrt(max(nominal**2 + deviation, 0.0))
        return root, error / (2.0 * max(root, sqrt(error)))
    return deviation, error


SQUARED = ("lens_blur", "exposure_time")
"""Fitted as squares, for blurs add up as variances; told as what they are, not as differences."""


def nominal_root(number: Number, case: PictureCase) -> float:
    """Nominal value of a number that is fitted as its square."""
    look = case.look.camera
    return {"lens_blur": look.lens_blur_px, "exposure_time": look.exposure_time_s}[number.name]
