"""Experiment 5: how wide the spot on a board is (paper Fig. 19)."""

from dataclasses import dataclass

import numpy as np

from diagnosis.validation.range_sensor.check import Check
from diagnosis.validation.range_sensor.paper import FIELD_OF_VIEW_MM, footprint_mm
from diagnosis.validation.range_sensor.recorder import Recorder
from diagnosis.validation.range_sensor.stand import HEIGHT_M, Bench, Stand, closed_form, target

WITHIN = 0.05


@dataclass(frozen=True)
class Spot:
    """Where the rays of one sensor meet a board."""

    distance_mm: float
    diameter_mm: float
    """Twice the largest distance of a ray's end from the axis."""
    paper_mm: float
    y_mm: tuple[float, ...]
    z_mm: tuple[float, ...]
    """(rays,) each, from the axis."""


def spots(bench: Bench) -> tuple[Spot, ...]:
    return tuple(_spot(bench, distance_mm) for distance_mm in FIELD_OF_VIEW_MM)


def _spot(bench: Bench, distance_mm: float) -> Spot:
    arena = target(1e-3 * distance_mm)
    recorder = Recorder(closed_form(arena))
    bench.sensor(arena, "field of view", distance_mm).sample(Stand(recorder))
    points = recorder.points()[: bench.tof.rays]
    y, z = 1e3 * points[:, 1], 1e3 * (points[:, 2] - HEIGHT_M)
    return Spot(
        distance_mm=distance_mm,
        diameter_mm=2.0 * float(np.hypot(y, z).max()),
        paper_mm=footprint_mm(distance_mm),
        y_mm=tuple(y.tolist()),
        z_mm=tuple(z.tolist()),
    )


def checks_of(found: tuple[Spot, ...]) -> list[Check]:
    shares = [spot.diameter_mm / spot.paper_mm for spot in found]
    return [
        Check(
            "field of view, diameter over 2 d tan 12.5",
            all(abs(share - 1.0) <= WITHIN for share in shares),
            f"{min(shares):.3f} to {max(shares):.3f}",
            f"{1 - WITHIN:.2f} to {1 + WITHIN:.2f}",
        )
    ]
