"""Experiment 4: the sensor tilted in place before a white board, to the sides and up and down (paper Fig. 18).

The sensor turns about itself and so keeps its distance, square to the board; the axis meets the board further away.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from diagnosis.validation.range_sensor.check import Check
from diagnosis.validation.range_sensor.paper import DISTANCES_MM
from diagnosis.validation.range_sensor.stand import Bench, Stand, closed_form, grid, seen_mm, target

ANGLES_DEG = tuple(grid(-25.0, 25.0, 2.0).tolist())
"""As in the paper; 0 is not among them."""
NOISE_SDS = 4.0
"""How many standard errors two means may be apart: 156 pairs, of which none in a hundred benches by chance."""
SMALLEST_SD_MM = 0.01
"""Taken for that of a sensor without noise, whose standard errors would be 0."""

Axis = Literal["sideways", "up_and_down"]


@dataclass(frozen=True)
class TiltCurve:
    axis: Axis
    distance_mm: float
    angle_deg: tuple[float, ...]
    mean_mm: tuple[float, ...]
    sd_mm: tuple[float, ...]
    readings: int
    """At each angle."""
    noiseless_mm: tuple[float, ...]
    level_mm: float
    """Noiseless, at 0 degrees."""
    largest_asymmetry_mm: float
    """Largest difference between the means at plus and minus one angle."""
    largest_asymmetry_se: float
    """The same in standard errors of the difference."""
    noiseless_asymmetry_mm: float


def tilt_curves(bench: Bench, readings: int) -> tuple[TiltCurve, ...]:
    axes: tuple[Axis, ...] = ("sideways", "up_and_down")
    return tuple(_curve(bench, axis, distance, readings) for axis in axes for distance in DISTANCES_MM)


def _curve(bench: Bench, axis: Axis, distance_mm: float, count: int) -> TiltCurve:
    arena = target(1e-3 * distance_mm)
    rays = closed_form(arena)

    def placed(angle_deg: float) -> tuple[Stand, float]:
        if axis == "sideways":
            return Stand(rays, yaw_deg=angle_deg), 0.0
        return Stand(rays), angle_deg

    still = bench.without_noise()

    def noiseless(angle_deg: float) -> float:
        stand, pitch_deg = placed(angle_deg)
        return seen_mm(still.sensor(arena, "tilt", axis, pitch_up_deg=pitch_deg), stand, distance_mm)

    exact = np.array([noiseless(angle) for angle in ANGLES_DEG])
    means, sds, fewest = [], [], count
    for angle_deg in ANGLES_DEG:
        stand, pitch_deg = placed(angle_deg)
        sensor = bench.sensor(arena, "tilt", axis, distance_mm, angle_deg, pitch_up_deg=pitch_deg)
        found = bench.readings_mm(sensor, stand, count)
        means.append(float(found.mean()))
        sds.append(float(found.std(ddof=1)))
        fewest = min(fewest, len(found))
    mean, sd = np.array(means), np.maximum(sds, SMALLEST_SD_MM)
    apart = np.abs(mean - mean[::-1])
    return TiltCurve(
        axis=axis,
        distance_mm=distance_mm,
        angle_deg=ANGLES_DEG,
        mean_mm=tuple(means),
        sd_mm=tuple(sds),
        readings=fewest,
        noiseless_mm=tuple(exact.tolist()),
        level_mm=noiseless(0.0),
        largest_asymmetry_mm=float(apart.max()),
        largest_asymmetry_se=float((apart / np.sqrt((sd**2 + sd[::-1] ** 2) / fewest)).max()),
        noiseless_asymmetry_mm=float(np.abs(exact - exact[::-1]).max()),
    )


def checks_of(curves: tuple[TiltCurve, ...]) -> list[Check]:
    worst = max(curves, key=lambda curve: curve.largest_asymmetry_se)
    lean = max(curve.noiseless_asymmetry_mm for curve in curves)
    half = len(ANGLES_DEG) // 2
    # The rise of the noiseless curve to both sides; the mean of a few readings may fall by chance near 0.
    with_angle = all((np.diff(arm) > 0).all() for curve in curves for arm in _arms(curve, half))
    rises = {axis: [c.noiseless_mm[-1] - c.level_mm for c in curves if c.axis == axis] for axis in _axes(curves)}
    with_distance = all((np.diff(rise) > 0).all() for rise in rises.values())
    return [
        Check(
            "tilt, symmetric within noise",
            worst.largest_asymmetry_se <= NOISE_SDS,
            f"at most {worst.largest_asymmetry_se:.1f} standard errors or {worst.largest_asymmetry_mm:.2f} mm apart "
            f"({worst.axis}, {worst.distance_mm:.0f} mm), without noise {lean:.2f} mm",
            f"{NOISE_SDS:.0f} standard errors",
        ),
        Check("tilt, rising with the angle", with_angle, "all curves" if with_angle else "not all", "all curves"),
        Check(
            "tilt, rising with the distance",
            with_distance,
            "at 25 degrees " + ", ".join(f"{rise:+.1f}" for rise in next(iter(rises.values()))) + " mm",
            "each more than the one before",
        ),
    ]


def _axes(curves: tuple[TiltCurve, ...]) -> list[Axis]:
    return list(dict.fromkeys(curve.axis for curve in curves))


def _arms(curve: TiltCurve, half: int) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """From 1 to 25 degrees and from -1 to -25."""
    return curve.noiseless_mm[half:], curve.noiseless_mm[:half][::-1]
