"""Mixed ranges at the edge of a ball in front of a board: a real scan, the sensor, and a cone with falling light."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from diagnosis.validation.experiment import ExperimentResult
from diagnosis.validation.measures import rms
from diagnosis.validation.panels import Curve, Panel
from diagnosis.validation.range_sensor.paper import footprint_mm
from diagnosis.validation.range_sensor.recordings.ball_scene import BALL, BOARD, BallScene, Cone
from diagnosis.validation.range_sensor.recordings.scan import ScanRecording
from diagnosis.validation.range_sensor.stand import HEIGHT_M, SensorOnStand, arena_of, board
from diagnosis.validation.range_sensor.step import places_of_shares
from symolo.core.arrays import Array
from symolo.pages.plotting import BLACK, BLUE, VERMILION

INNER_MM = 30.0
"""Distance from the nearest reading up to which readings are of the ball alone, or nearly."""
MIN_INNER = 12
RING_MM = 4.0
START_RADIUS_MM = 40.0
MIN_RADIUS_MM = 5.0
DIFFERENCE = 0.02
"""Relative step of the numerical slope of the fit. A planted ball of 30 mm at 160 mm is fitted as 34 mm at 165 mm."""
CLEARLY = 0.8
"""Ratio of the residuals of two laws of light, below which the first explains a scan better."""


@dataclass(frozen=True)
class BallFit:
    """The ball that explains the readings of its middle best, for one law of light."""

    falls_with_power: float
    """Power of the distance with which light falls off: 0 as in the sensor, 2 for real light."""
    x_mm: float
    y_mm: float
    nearest_mm: float
    radius_mm: float
    inner_rms_mm: float
    all_rms_mm: float
    """Residual that includes the outer part of the ball, which was not fitted."""


@dataclass(frozen=True)
class _HalfScan:
    """Points of the scan from the middle of the ball to the side where nothing holds the ball."""

    places_mm: Array
    """(P, 2), x and y of the points."""
    reading_mm: Array
    """(P,), settled readings."""
    board_mm: float


def ball_edge(mounted: SensorOnStand, scan: ScanRecording) -> ExperimentResult | None:
    """Return fits of the ball and profiles across its edge; None for a scan without a near object and a far board."""
    half = _half(scan)
    inner = half.reading_mm < half.reading_mm.min() + INNER_MM
    if inner.sum() < MIN_INNER or half.board_mm < half.reading_mm.min() + 3.0 * INNER_MM:
        return None
    cone = Cone.of_sensor(mounted.tof)
    plain, falling = (_fit(cone, half, inner, power) for power in (0.0, 2.0))
    readings = (half.reading_mm, _with_sensor(mounted, half, falling), _readings(cone, half, falling))
    real, model, with_light = (_profile(half, falling, reading) for reading in readings)
    rim_footprint_mm = footprint_mm(falling.nearest_mm + falling.radius_mm)
    tables = {
        "board": {"board_mm": half.board_mm, "rim_footprint_mm": rim_footprint_mm},
        "ball by the sensor's light": vars(plain),
        "ball by falling light": vars(falling),
        "edge measured": real,
        "edge by the model": model,
        "edge by falling light": with_light,
    }
    better = falling.inner_rms_mm < CLEARLY * plain.inner_rms_mm
    outshine = (
        ". NOT IN THE MODEL: near things outshine far ones. It weighs a ray by beam and incidence only, so that its "
        "ranges at edges are too long and near things look too small"
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
            f"by the model these are {model['middle_mm']:.0f} and {model['width_10_90_mm']:.0f} mm, by falling light "
            f"{with_light['middle_mm']:.0f} and {with_light['width_10_90_mm']:.0f} mm (the footprint there is "
            f"{rim_footprint_mm:.0f} mm){outshine if better else '; falling light does not explain it better'}"
        ),
    )
    curves = (
        Curve(real["radius_mm"], real["reading_mm"], "measured", BLACK, "o"),
        Curve(model["radius_mm"], model["reading_mm"], "model", VERMILION),
        Curve(with_light["radius_mm"], with_light["reading_mm"], "model, were light to fall as 1/d²", BLUE, "--"),
    )
    title = "Mixed ranges at the edge of a ball (dashed: its fitted edge)"
    axes = ("distance from the ball's centre, across [mm]", "median reading [mm]")
    panel = Panel(title, *axes, curves, x_lines=(falling.radius_mm,), y_range=(0.0, None))
    return ExperimentResult(tables, panels=(panel,), notes=notes)


def _half(scan: ScanRecording) -> _HalfScan:
    """Return the side of the scan on which the board is seen at the rim; the other side shows what holds the ball."""
    settled = scan.settled_mm
    middle = float(np.median(scan.y_mm[settled < settled.min() + 0.3 * INNER_MM]))
    first, last = (np.median(settled[scan.y_mm == end]) for end in (scan.y_mm.min(), scan.y_mm.max()))
    outward = 1.0 if last >= first else -1.0
    beyond = outward * (scan.y_mm - middle) >= -0.5 * START_RADIUS_MM
    places = np.stack([scan.x_mm, scan.y_mm], axis=1)[beyond]
    return _HalfScan(places, settled[beyond], float(last if outward > 0 else first))


def _scene(fit: BallFit, board_mm: float) -> BallScene:
    ball = 1e-3 * fit.nearest_mm, 1e-3 * fit.radius_mm
    return BallScene(*ball, 1e-3 * board_mm, 1e-3 * fit.x_mm, HEIGHT_M + 1e-3 * fit.y_mm)


def _readings(cone: Cone, half: _HalfScan, fit: BallFit) -> Array:
    """Return readings (P,) [mm] for a law of light; x of the scan is y on the stand, and y is its height."""
    across = 1e-3 * half.places_mm
    places = np.stack([np.zeros(len(across)), across[:, 0], HEIGHT_M + across[:, 1]], axis=1)
    return 1e3 * cone.ranges_m(_scene(fit, half.board_mm), places, fit.falls_with_power)


def _fit(cone: Cone, half: _HalfScan, inner: NDArray[np.bool_], power: float) -> BallFit:
    nearest = float(half.reading_mm.min())
    x_mm, y_mm = half.places_mm[half.reading_mm < nearest + 0.3 * INNER_MM].mean(axis=0).tolist()
    middle = replace(half, places_mm=half.places_mm[inner], reading_mm=half.reading_mm[inner])

    def ball(values: Array) -> BallFit:
        x, y, near, radius = values.tolist()
        return BallFit(power, x, y, near, radius, inner_rms_mm=0.0, all_rms_mm=0.0)

    def residual(values: Array) -> Array:
        return _readings(cone, middle, ball(values)) - middle.reading_mm

    solution = least_squares(
        residual,
        (x_mm, y_mm, nearest, START_RADIUS_MM),
        bounds=([-1e3, -1e3, 1.0, MIN_RADIUS_MM], [1e3, 1e3, 2e3, 500.0]),
        x_scale=(1.0, 1.0, 1.0, 5.0),
        # Rays leave the ball one by one at its rim, so the residuals have steps; a small difference would miss them.
        diff_step=DIFFERENCE,
    )
    fit = ball(solution.x)
    outside = _readings(cone, half, fit) - half.reading_mm
    return replace(fit, inner_rms_mm=rms(solution.fun), all_rms_mm=rms(outside))


def _with_sensor(mounted: SensorOnStand, half: _HalfScan, fit: BallFit) -> Array:
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


def _profile(half: _HalfScan, fit: BallFit, reading: Array) -> dict:
    """Return the median reading in rings about the ball's centre, and where it changes from ball to board."""
    ring = np.round(np.hypot(*(half.places_mm - (fit.x_mm, fit.y_mm)).T) / RING_MM).astype(int)
    # Rings that the scan's border cuts are left out, because the board would be missing at their outer end.
    rings = [number for number in np.unique(ring) if (ring == number).sum() >= 3]
    radius = RING_MM * np.array(rings, dtype=float)
    median = np.array([np.median(reading[ring == number]) for number in rings])
    start, middle, end = places_of_shares(radius, median, (0.1, 0.5, 0.9))
    return {"radius_mm": radius, "reading_mm": median, "width_10_90_mm": end - start, "middle_mm": middle}
