"""Experiment 4: the sensor tilted in place before a white board, to the sides and up and down (paper Fig. 18).

The sensor turns about its own place, so its perpendicular distance stays the same, and its axis meets the board further
away.
"""

from collections.abc import Mapping
from typing import Literal

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.validation.experiment import ExperimentResult, ValidationCheck
from diagnosis.validation.measures import mean_and_sd
from diagnosis.validation.panels import COLORS, DASHES, MARKERS, Curve, Panel
from diagnosis.validation.range_sensor.paper import DISTANCES_MM
from diagnosis.validation.range_sensor.stand import SensorOnStand, grid, target
from sensors.effects.range_sensor.tilt_asymmetry import TiltAsymmetry
from symolo.core.arrays import Array
from symolo.pages.plotting import GREY

ANGLES_DEG = tuple(grid(-25.0, 25.0, 2.0).tolist())
"""Angles as in the paper; 0 is not among them."""
MAX_STANDARD_ERRORS = 4.0
"""Largest allowed difference of two means: in 100 repetitions, none of the 156 pairs exceeds it by chance."""
MIN_SD_MM = 0.01
"""Standard deviation that is used for a sensor without noise, whose standard errors would be 0."""

Axis = Literal["sideways", "up_and_down"]
AXES: tuple[Axis, ...] = ("sideways", "up_and_down")


def tilt(robot: RobotConfig, seed: int, readings: int) -> ExperimentResult:
    """Return means of readings against the angle, about both axes and at each of the paper's distances."""
    mounted = SensorOnStand.from_robot(robot, seed)
    curves = {f"{axis} at {d:g} mm": curve(mounted, axis, d, readings) for axis in AXES for d in DISTANCES_MM}
    note = (
        "the up-and-down curves of the paper lean to one side (no figure); the model has emitter and receiver at one "
        "place, and is symmetric about both axes without tilt_asymmetry"
    )
    return ExperimentResult(curves, checks_of(curves), (_panel(curves),), (note,))


def curve(mounted: SensorOnStand, axis: Axis, distance_mm: float, count: int) -> dict:
    """Return mean and deviation of `count` readings at each angle, and one reading without noise."""
    arena = target(1e-3 * distance_mm)
    noiseless = mounted.without_noise()

    def yaw_and_pitch(angle_deg: float) -> tuple[float, float]:
        return (angle_deg, 0.0) if axis == "sideways" else (0.0, angle_deg)

    def exact_mm(angle_deg: float) -> float:
        yaw_deg, pitch_deg = yaw_and_pitch(angle_deg)
        return noiseless.facing(arena, "tilt", axis, pitch_up_deg=pitch_deg).seen_mm(distance_mm, yaw_deg=yaw_deg)

    exact = np.array([exact_mm(angle) for angle in ANGLES_DEG])
    means_and_sds, valid = [], count
    for angle_deg in ANGLES_DEG:
        yaw_deg, pitch_deg = yaw_and_pitch(angle_deg)
        scene = mounted.facing(arena, "tilt", axis, distance_mm, angle_deg, pitch_up_deg=pitch_deg)
        readings = scene.readings_mm(count, yaw_deg)
        means_and_sds.append(mean_and_sd(readings))
        valid = min(valid, len(readings))
    mean, measured_sd = np.array(means_and_sds).T
    sd = np.maximum(measured_sd, MIN_SD_MM)
    apart = np.abs(mean - mean[::-1] - 2.0 * _leaning_mm(mounted, axis))
    return {
        "axis": axis,
        "distance_mm": distance_mm,
        "angle_deg": ANGLES_DEG,
        "mean_mm": mean,
        "sd_mm": measured_sd,
        "readings_at_each_angle": valid,
        "noiseless_mm": exact,
        "level_mm": exact_mm(0.0),
        "largest_asymmetry_mm": float(apart.max()),
        "largest_asymmetry_standard_errors": float((apart / np.sqrt((sd**2 + sd[::-1] ** 2) / valid)).max()),
        "noiseless_asymmetry_mm": float(np.abs(exact - exact[::-1]).max()),
    }


def _leaning_mm(mounted: SensorOnStand, axis: Axis) -> Array:
    """Return what the robot's tilt_asymmetry adds at each angle about an axis."""
    effect = mounted.effects.get(TiltAsymmetry)
    acts = effect is not None and (effect.axis == "sideways") == (axis == "sideways")
    return 1e3 * np.radians(ANGLES_DEG) * (effect.coefficient_m_per_rad if effect is not None and acts else 0.0)


def checks_of(curves: Mapping[str, dict]) -> list[ValidationCheck]:
    """Return the checks of curves about each axis at rising distances."""
    name, worst = max(curves.items(), key=lambda item: item[1]["largest_asymmetry_standard_errors"])
    half = len(ANGLES_DEG) // 2
    # Without noise, because near 0 the mean of a few readings may fall by chance.
    arms = [arm for c in curves.values() for arm in (c["noiseless_mm"][half:], c["noiseless_mm"][:half][::-1])]
    falling = sum(not (np.diff(arm) > 0).all() for arm in arms)
    rises: dict[str, list[float]] = {axis: [] for axis in AXES}
    for c in curves.values():
        rises[c["axis"]].append(c["noiseless_mm"][-1] - c["level_mm"])
    not_rising = sum(not (np.diff(rise) > 0).all() for rise in rises.values())
    detail = (
        f"{name}, {worst['largest_asymmetry_mm']:.2f} mm; without noise at most "
        f"{max(c['noiseless_asymmetry_mm'] for c in curves.values()):.2f} mm"
    )
    sideways = ", ".join(f"{rise:+.1f}" for rise in rises["sideways"])
    return [
        ValidationCheck(
            "largest asymmetry beyond tilt_asymmetry",
            worst["largest_asymmetry_standard_errors"],
            0.0,
            MAX_STANDARD_ERRORS,
            "a symmetric cone",
            "standard errors",
            detail,
        ),
        ValidationCheck("sides of curves that do not rise with the angle", falling, 0, 0, "the paper's Fig. 18"),
        ValidationCheck(
            "axes whose rise does not grow with the distance",
            not_rising,
            0,
            0,
            "the paper's Fig. 18",
            detail=f"at 25 degrees {sideways} mm",
        ),
    ]


def _panel(curves: Mapping[str, dict]) -> Panel:
    shown = []
    for axis in AXES:
        for k, table in enumerate(table for table in curves.values() if table["axis"] == axis):
            angle, mean = table["angle_deg"], table["mean_mm"]
            if axis == "sideways":
                shown.append(Curve(angle, table["noiseless_mm"], "", COLORS[k], DASHES[k]))
                shown.append(Curve(angle, mean, f"at {table['distance_mm']:.0f} mm", COLORS[k], MARKERS[k], size=4))
            else:
                shown.append(Curve(angle, mean, "" if k else "up and down", GREY, "+", size=7))
    title = "4  Tilt: means to the sides, lines without noise"
    return Panel(title, "angle [°]", "mean reading [mm]", shown, y_range=(0.0, 620.0))
