"""Mixed ranges at the edge of a ball in front of a board: a real scan, the sensor, and a cone with falling light."""

from dataclasses import dataclass, replace

import numpy as np

from configs.effects.robot_effects import RobotEffects
from diagnosis.validation.experiment import ExperimentResult
from diagnosis.validation.measures import rms
from diagnosis.validation.panels import Curve, Panel
from diagnosis.validation.range_sensor.paper import footprint_mm
from diagnosis.validation.range_sensor.recordings.ball_fit import HalfScan, SmoothBeam, fitted_ball
from diagnosis.validation.range_sensor.recordings.ball_scene import BALL, BOARD, BallScene
from diagnosis.validation.range_sensor.recordings.scan import ScanRecording
from diagnosis.validation.range_sensor.stand import HEIGHT_M, SensorOnStand, arena_of, board
from diagnosis.validation.range_sensor.step import places_of_shares
from sensors.effects.range_sensor.range_signal_weighting import RangeSignalWeighting
from symolo.core.arrays import Array
from symolo.pages.plotting import BLACK, BLUE, VERMILION

RING_MM = 4.0
CLEARLY = 0.8
"""Ratio of the residuals of two laws of light, below which the first explains a scan better."""


@dataclass(frozen=True)
class BallFit:
    """The ball that explains the readings of its middle best, for one law of light."""

    exponent: float
    """Power of the distance with which light falls off: 0 as in the sensor, 2 for real light."""
    x_mm: float
    y_mm: float
    nearest_mm: float
    radius_mm: float
    inner_rms_mm: float
    all_rms_mm: float
    """Residual that includes the outer part of the ball, which was not fitted."""


def ball_edge(mounted: SensorOnStand, scan: ScanRecording) -> ExperimentResult | None:
    """Return fits of the ball and profiles across its edge; None for a scan without a near object and a far board."""
    half = HalfScan.from_scan(scan)
    if not half.shows_a_ball:
        return None
    (plain, _), (falling, with_light_mm) = (_fit(mounted, half, exponent) for exponent in (0.0, 2.0))
    readings = (half.reading_mm, _with_sensor(mounted, half, falling), with_light_mm)
    real, model, with_light = (_profile(half, falling, reading) for reading in readings)
    rim_footprint_mm = footprint_mm(falling.nearest_mm + falling.radius_mm)
    tables = {
        "board": {"board_mm": half.board_mm, "rim_footprint_mm": rim_footprint_mm},
        "ball by the sensor's light": vars(plain),
        "ball by inverse-square light": vars(falling),
        "edge measured": real,
        "edge by the model": model,
        "edge by inverse-square light": with_light,
    }
    better = falling.inner_rms_mm < CLEARLY * plain.inner_rms_mm
    near_light = (
        ". NOT IN THIS ROBOT: near objects return more light than far ones. Without range_signal_weighting, a ray is "
        "weighted by beam and incidence only, so that ranges at edges are too long and near objects look too small"
    )
    notes = (
        (
            f"a ball in front of a board at {half.board_mm:.0f} mm: the model fits the middle of the ball to "
            f"{plain.inner_rms_mm:.1f} mm rms with a radius of {plain.radius_mm:.0f} mm; a model in which light falls "
            f"with the square of the distance fits it to {falling.inner_rms_mm:.1f} mm with {falling.radius_mm:.0f} mm"
        ),
        (
            f"across the edge of that ball of {falling.radius_mm:.0f} mm, the real range is half-way to the board "
            f"{real['middle_mm']:.0f} mm from the centre, and goes from 10 to 90 % in {real['width_10_90_mm']:.0f} mm; "
            f"by the model these are {model['middle_mm']:.0f} and {model['width_10_90_mm']:.0f} mm, by inverse-square "
            f"light {with_light['middle_mm']:.0f} and {with_light['width_10_90_mm']:.0f} mm (the footprint there is "
            f"{rim_footprint_mm:.0f} mm){near_light if better else '; inverse-square light does not explain it better'}"
        ),
    )
    curves = (
        Curve(real["radius_mm"], real["reading_mm"], "measured", BLACK, "o"),
        Curve(model["radius_mm"], model["reading_mm"], "model", VERMILION),
        Curve(with_light["radius_mm"], with_light["reading_mm"], "model with range_signal_weighting", BLUE, "--"),
    )
    title = "Mixed ranges at the edge of a ball (dashed: its fitted edge)"
    axes = ("distance from the ball's centre, across [mm]", "median reading [mm]")
    panel = Panel(title, *axes, curves, x_lines=(falling.radius_mm,), y_range=(0.0, None))
    return ExperimentResult(tables, panels=(panel,), notes=notes)


def _fit(mounted: SensorOnStand, half: HalfScan, exponent: float) -> tuple[BallFit, Array]:
    """Return the ball for a law of light, and the readings (P,) [mm] of the scan with it."""
    beam = SmoothBeam(mounted.tof, RobotEffects((RangeSignalWeighting(exponent=exponent),)))

    def law(nearest_m: float, radius_m: float, off_m: Array) -> Array:
        return beam.seen(nearest_m, radius_m, 1e-3 * half.board_mm, off_m)[0]

    ball = fitted_ball(law, half.places_mm[half.inner], half.reading_mm[half.inner])
    readings_mm = ball.readings_mm(law, half.places_mm)
    error_mm = readings_mm - half.reading_mm
    fit = BallFit(exponent, **vars(ball), inner_rms_mm=rms(error_mm[half.inner]), all_rms_mm=rms(error_mm))
    return fit, readings_mm


def _scene(fit: BallFit, board_mm: float) -> BallScene:
    ball = 1e-3 * fit.nearest_mm, 1e-3 * fit.radius_mm
    return BallScene(*ball, 1e-3 * board_mm, 1e-3 * fit.x_mm, HEIGHT_M + 1e-3 * fit.y_mm)


def _with_sensor(mounted: SensorOnStand, half: HalfScan, fit: BallFit) -> Array:
    """Return readings (P,) of the simulated sensor without noise, past which the ball is moved."""
    # The order of the boards gives the surfaces their numbers: the ball is 1, the board 2.
    boards = {BALL: board("ball", 0.1, 1.0), BOARD: board("board", 1.0, 1.0)}
    # The scan has an unknown offset, so only the mean over the cone is compared.
    exact = replace(mounted, tof=mounted.tof.model_copy(update={"error_scale": 0.0})).without_noise()
    on_stand, ball = exact.facing(arena_of(*boards.values()), "edge"), _scene(fit, half.board_mm)
    moved = (
        replace(ball, y_m=ball.y_m - 1e-3 * x_mm, z_m=ball.z_m - 1e-3 * y_mm) for x_mm, y_mm in half.places_mm.tolist()
    )
    return np.array([replace(on_stand, caster=scene).reading_mm() for scene in moved])


def _profile(half: HalfScan, fit: BallFit, reading: Array) -> dict:
    """Return the median reading in rings about the ball's centre, and where it changes from ball to board."""
    ring = np.round(np.hypot(*(half.places_mm - (fit.x_mm, fit.y_mm)).T) / RING_MM).astype(int)
    # Rings that the scan's border cuts are left out, because the board would be missing at their outer end.
    rings = [number for number in np.unique(ring) if (ring == number).sum() >= 3]
    radius = RING_MM * np.array(rings, dtype=float)
    median = np.array([np.median(reading[ring == number]) for number in rings])
    start, middle, end = places_of_shares(radius, median, (0.1, 0.5, 0.9))
    return {"radius_mm": radius, "reading_mm": median, "width_10_90_mm": end - start, "middle_mm": middle}
