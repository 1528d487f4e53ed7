"""A deviation in a user's terms: a difference from the nominal camera, a factor, or the value itself."""

from math import exp, sqrt

from diagnosis.camera.case import CameraCase
from diagnosis.camera.parameter import CameraNumber


def value_of(number: CameraNumber, x: float, sd: float, case: CameraCase) -> tuple[float, float]:
    """Return value and standard error in the number's unit from a deviation and its standard error in tolerances."""
    deviation, error = x * number.tolerance, sd * number.tolerance
    if number.name.endswith("_scale"):
        return exp(deviation), exp(deviation) * error
    if number.name in SQUARED:
        nominal = nominal_root(number, case)
        root = sqrt(max(nominal**2 + deviation, 0.0))
        return root, error / (2.0 * max(root, sqrt(error)))
    return deviation, error


SQUARED = ("lens_blur", "exposure_time")
"""Numbers that are fitted as squares, because blurs add up as variances, and reported as values, not differences."""


def nominal_root(number: CameraNumber, case: CameraCase) -> float:
    """Return the nominal value of a number that is fitted as its square."""
    look = case.look.camera
    return {"lens_blur": look.lens_blur_px, "exposure_time": look.exposure_time_s}[number.name]
