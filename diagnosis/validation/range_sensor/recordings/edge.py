"""Mixed ranges at the edge of a ball before a board: a real scan, the sensor's mean, and one with the falling light."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from diagnosis.validation.range_sensor.paper import footprint_mm
from diagnosis.validation.range_sensor.recordings.cone import Cone
from diagnosis.validation.range_sensor.recordings.scan import ScanRecord
from diagnosis.validation.range_sensor.recordings.sphere import BALL, BOARD, BallScene
from diagnosis.validation.range_sensor.stand import HEIGHT_M, Bench, Stand, bench_arena, board, reading_mm
from diagnosis.validation.range_sensor.step import where_gone
from symolo.core.arrays import Array

INNER_MM = 30.0
"""Readings within this of the nearest are of the ball alone, or nearly."""
FEWEST_INNER = 12
RING_MM = 4.0
START_RADIUS_MM = 40.0
SMALLEST_RADIUS_MM = 5.0
DIFFERENCE = 0.02
"""Of a value, over which the fit takes its slope. A planted ball of 30 mm at 160 mm comes out as 34 mm at 165 mm."""


@dataclass(frozen=True)
class BallFit:
    """The ball that explains the readings of its middle best, under one law of light."""

    falls_with_power: float
    """Of the distance: 0 as the sensor has it, 2 as light falls."""
    x_mm: float
    y_mm: float
    nearest_mm: float
    radius_mm: float
    inner_rms_mm: float
    all_rms_mm: float
    """Over the outer side of the ball too, which was not fitted."""


@dataclass(frozen=True)
class EdgeProfile:
    """Median reading in rings about the ball's centre."""

    name: str
    radius_mm: tuple[float, ...]
    reading_mm: tuple[float, ...]
    width_10_90_mm: float
    middle_mm: float
    """Ring at which half of the way from ball to board is done."""


@dataclass(frozen=True)
class EdgeComparison:
    board_mm: float
    """Median reading beside the ball."""
    sensor_fit: BallFit
    falling_fit: BallFit
    rim_footprint_mm: float
    """2 d tan 12.5 at the distance of the rim of the second ball."""
    measured: EdgeProfile
    model: EdgeProfile
    """The simulator's own sensor before the second ball."""
    falling: EdgeProfile


@dataclass(frozen=True)
class _Half:
    """Points of the scan from the ball's middle on to the side that nothing holds it from."""

    places_mm: Array
    """(P, 2)."""
    reading_mm: Array
    board_mm: float


def compare_edge(bench: Bench, scan: ScanRecord) -> EdgeComparison | None:
    """None where the scan has no near thing before a far one."""
    half = _half(scan)
    inner = half.reading_mm < half.reading_mm.min() + INNER_MM
    if inner.sum() < FEWEST_INNER or half.board_mm < half.reading_mm.min() + 3.0 * INNER_MM:
        return None
    cone = Cone.of(bench.tof)
    plain, falling = (_fit(cone, half, inner, power) for power in (0.0, 2.0))
    names = ("measured", "model", "model, light falling with the square")
    modelled = _with_sensor(bench, half, falling)
    would_be = _readings(cone, half, falling)
    real, model, with_light = (
        _profile(name, half, falling, reading)
        for name, reading in zip(names, (half.reading_mm, modelled, would_be), strict=True)
    )
    rim_mm = falling.nearest_mm + falling.radius_mm
    return EdgeComparison(half.board_mm, plain, falling, footprint_mm(rim_mm), real, model, with_light)


def _half(scan: ScanRecord) -> _Half:
    """What holds the ball is in view on one side of y; the other side, where the board shows at the rim, is taken."""
    settled = scan.settled_mm
    middle = float(np.median(scan.y_mm[settled < settled.min() + 0.3 * INNER_MM]))
    first, last = (np.median(settled[scan.y_mm == end]) for end in (scan.y_mm.min(), scan.y_mm.max()))
    outward = 1.0 if last >= first else -1.0
    beyond = outward * (scan.y_mm - middle) >= -0.5 * START_RADIUS_MM
    places = np.stack([scan.x_mm, scan.y_mm], axis=1)[beyond]
    rim = settled[scan.y_mm == (scan.y_mm.max() if outward > 0 else scan.y_mm.min())]
    return _Half(places, settled[beyond], float(np.median(rim)))


def _scene(fit: BallFit, board_mm: float) -> BallScene:
    ball = 1e-3 * fit.nearest_mm, 1e-3 * fit.radius_mm
    return BallScene(*ball, 1e-3 * board_mm, 1e-3 * fit.x_mm, HEIGHT_M + 1e-3 * fit.y_mm)


def _readings(cone: Cone, half: _Half, fit: BallFit) -> Array:
    """(P,) [mm]; the sensor moves over the ball: x of the scan is y of the stand, and y its height."""
    across = 1e-3 * half.places_mm
    places = np.stack([np.zeros(len(across)), across[:, 0], HEIGHT_M + across[:, 1]], axis=1)
    return 1e3 * cone.ranges_m(_scene(fit, half.board_mm), places, fit.falls_with_power)


def _fit(cone: Cone, half: _Half, inner: NDArray[np.bool_], power: float) -> BallFit:
    nearest = float(half.reading_mm.min())
    x_mm, y_mm = half.places_mm[half.reading_mm < nearest + 0.3 * INNER_MM].mean(axis=0).tolist()
    middle = replace(half, places_mm=half.places_mm[inner], reading_mm=half.reading_mm[inner])

    def ball(values: Array) -> BallFit:
        x, y, near, radius = values.tolist()
        return BallFit(power, x, y, near, radius, inner_rms_mm=0.0, all_rms_mm=0.0)

    def residual(values: Array) -> Array:
        return _readings(cone, middle, ball(values)) - middle.reading_mm

    found = least_squares(
        residual,
        (x_mm, y_mm, nearest, START_RADIUS_MM),
        bounds=([-1e3, -1e3, 1.0, SMALLEST_RADIUS_MM], [1e3, 1e3, 2e3, 500.0]),
        x_scale=(1.0, 1.0, 1.0, 5.0),
        # Rays fall off the rim one by one: smaller steps see the slope between two falls only.
        diff_step=DIFFERENCE,
    )
    fit = ball(found.x)
    outside = _readings(cone, half, fit) - half.reading_mm
    return replace(fit, inner_rms_mm=_rms(found.fun), all_rms_mm=_rms(outside))


def _with_sensor(bench: Bench, half: _Half, fit: BallFit) -> Array:
    """The simulator's own sensor without noise at every point: the ball is moved past it."""
    # Their order gives the surfaces their numbers: the ball is 1, the board 2.
    boards = {BALL: board("ball", 0.1, 1.0), BOARD: board("board", 1.0, 1.0)}
    # The scan has unknown offsets; what is compared is the mean over the cone.
    exact = bench.tof.model_copy(update={"error_scale": 0.0})
    sensor = Bench(exact, bench.effects, bench.seed).without_noise().sensor(bench_arena(*boards.values()), "edge")
    scene = _scene(fit, half.board_mm)
    found = []
    for x_mm, y_mm in half.places_mm.tolist():
        moved = replace(scene, y_m=scene.y_m - 1e-3 * x_mm, z_m=scene.z_m - 1e-3 * y_mm)
        found.append(reading_mm(sensor, Stand(moved)))
    return np.array(found)


def _profile(name: str, half: _Half, fit: BallFit, reading: Array) -> EdgeProfile:
    ring = np.round(np.hypot(*(half.places_mm - (fit.x_mm, fit.y_mm)).T) / RING_MM).astype(int)
    # Outermost rings that the scan's border cuts have no board in them to come to.
    rings = [number for number in np.unique(ring) if (ring == number).sum() >= 3]
    radius = RING_MM * np.array(rings, dtype=float)
    median = np.array([np.median(reading[ring == number]) for number in rings])
    start, middle, end = where_gone(radius, median, (0.1, 0.5, 0.9))
    return EdgeProfile(name, tuple(radius.tolist()), tuple(median.tolist()), end - start, middle)


def _rms(residual: Array) -> float:
    return float(np.sqrt(np.mean(residual**2)))
