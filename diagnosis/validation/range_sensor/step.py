"""Experiment 3: across the edge of a box of 106 mm, at six distances (paper Fig. 17)."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from diagnosis.validation.crossing import first_reached
from diagnosis.validation.range_sensor.check import Check
from diagnosis.validation.range_sensor.paper import DISTANCES_MM, STEP_HEIGHT_MM, footprint_mm
from diagnosis.validation.range_sensor.stand import (
    TARGET_HALF_WIDTH_M,
    Bench,
    Stand,
    bench_arena,
    board,
    closed_form,
    grid,
    reading_mm,
    seen_mm,
)
from symolo.arena.geometry import Arena
from symolo.core.arrays import Array

EDGE_MM = 150.0
"""Of the box, on the way from 0 to 300 mm."""
WITHIN = 0.10


@dataclass(frozen=True)
class StepScan:
    """One way across the edge; the box is left behind at `EDGE_MM`."""

    distance_mm: float
    """To the top of the box."""
    position_mm: tuple[float, ...]
    reading_mm: tuple[float | None, ...]
    """As the sensor gives them, one at each position."""
    noiseless_mm: tuple[float, ...]
    before_mm: float
    after_mm: float
    """Ends of the noiseless scan."""
    width_10_90_mm: float
    """Of the noiseless scan, from 10 to 90 % of the way between its ends."""
    width_1_99_mm: float
    middle_mm: float
    """Where half of the way is done, from the edge."""
    footprint_mm: float


def step_scans(bench: Bench) -> tuple[StepScan, ...]:
    return tuple(_scan(bench, distance_mm) for distance_mm in DISTANCES_MM)


def step_arena(distance_mm: float) -> Arena:
    """The sensor moves along y, over the box while y < 0."""
    near, far = 1e-3 * distance_mm, 1e-3 * (distance_mm + STEP_HEIGHT_MM)
    box = board("box", near, 0.0, thickness_m=1e-3 * STEP_HEIGHT_MM)
    return bench_arena(box, board("table", far, TARGET_HALF_WIDTH_M))


def _scan(bench: Bench, distance_mm: float) -> StepScan:
    arena = step_arena(distance_mm)
    rays = closed_form(arena)
    shipped = bench.sensor(arena, "step", distance_mm)
    still = bench.without_noise().sensor(arena, "step", distance_mm)
    positions = grid(0.0, 300.0, 1.0)
    places = [Stand(rays, y_m=1e-3 * (position - EDGE_MM)) for position in positions.tolist()]
    readings = [reading_mm(shipped, place) for place in places]
    noiseless = np.array([seen_mm(still, place, distance_mm + STEP_HEIGHT_MM) for place in places])
    low, start, middle, end, high = where_gone(positions, noiseless, (0.01, 0.1, 0.5, 0.9, 0.99))
    return StepScan(
        distance_mm=distance_mm,
        position_mm=tuple(positions.tolist()),
        reading_mm=tuple(None if np.isnan(reading) else reading for reading in readings),
        noiseless_mm=tuple(noiseless.tolist()),
        before_mm=float(noiseless[0]),
        after_mm=float(noiseless[-1]),
        width_10_90_mm=end - start,
        width_1_99_mm=high - low,
        middle_mm=middle - EDGE_MM,
        footprint_mm=footprint_mm(distance_mm),
    )


def where_gone(position: Array, reading: Array, shares: tuple[float, ...]) -> tuple[float, ...]:
    """Where a reading first has gone each share of the way from its first to its last value, in units of `position`."""
    way = (reading - reading[0]) / (reading[-1] - reading[0])
    return tuple(first_reached(position, way, share) for share in shares)


def checks_of(scans: tuple[StepScan, ...]) -> list[Check]:
    shares = [scan.width_10_90_mm / scan.footprint_mm for scan in scans]
    nearly_all = [scan.width_1_99_mm / scan.footprint_mm for scan in scans]
    widths = [scan.width_10_90_mm for scan in scans]
    rising = all(narrow < wide for narrow, wide in pairwise(widths))
    return [
        Check(
            "step, 10-90 % width over the footprint 2 d tan 12.5",
            all(abs(share - 1.0) <= WITHIN for share in shares),
            f"{min(shares):.2f} to {max(shares):.2f} (a disc of even light has 0.69; "
            f"from 1 to 99 % it is {min(nearly_all):.2f} to {max(nearly_all):.2f})",
            "0.90 to 1.10",
        ),
        Check(
            "step, 10-90 % width grows with the distance",
            rising,
            ", ".join(f"{scan.width_10_90_mm:.1f} mm at {scan.distance_mm:.0f} mm" for scan in scans),
            "each wider than the one before",
        ),
    ]
