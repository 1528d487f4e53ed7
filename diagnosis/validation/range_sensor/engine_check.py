"""The same sensor on PyBullet's own rays: what its readings differ by from those on the rays of the simulation."""

from dataclasses import dataclass

import numpy as np

from diagnosis.validation.range_sensor.check import Check
from diagnosis.validation.range_sensor.paper import DISTANCES_MM
from diagnosis.validation.range_sensor.recorder import Recorder
from diagnosis.validation.range_sensor.stand import Bench, Stand, closed_form, grid, reading_mm, target
from diagnosis.validation.range_sensor.step import step_arena
from physics.bullet.ray_oracle import EngineRays
from symolo.arena.geometry import Arena

PLANE_WITHIN_MM = 0.1
EDGE_WITHIN_MM = 5.0
"""Where a ray may fall to this or that side of an edge that the engine rounds."""


@dataclass(frozen=True)
class EngineCheck:
    """Noiseless readings on both kinds of rays."""

    scene: str
    places: int
    rays: int
    largest_ray_mm: float
    """Largest difference in the length of a ray, of those that both say meet the same board."""
    rms_ray_mm: float
    other_board: int
    """Rays that meet another board or none."""
    largest_reading_mm: float


def engine_checks(bench: Bench) -> tuple[EngineCheck, ...]:
    """Boards met head-on and tilted, and the way across the step, at all distances, in PyBullet's world."""
    still = bench.without_noise()
    plane, step = [], []
    for distance_mm in DISTANCES_MM:
        board, edge = target(1e-3 * distance_mm), step_arena(distance_mm)
        plane.append((board, [(0.0, angle) for angle in grid(-25.0, 25.0, 5.0).tolist()]))
        step.append((edge, [(1e-3 * y, 0.0) for y in grid(-150.0, 150.0, 5.0).tolist()]))
    return _compared(still, "board, tilted", plane), _compared(still, "step", step)


def _compared(bench: Bench, scene: str, stations: list[tuple[Arena, list[tuple[float, float]]]]) -> EngineCheck:
    reading_off, ray_off, other = [], [], 0
    for arena, places in stations:
        sensor = bench.sensor(arena, "engine", scene)
        with EngineRays(arena) as engine:
            for y_m, yaw_deg in places:
                recorder = Recorder(closed_form(arena))
                ours = reading_mm(sensor, Stand(recorder, y_m=y_m, yaw_deg=yaw_deg))
                theirs = reading_mm(sensor, Stand(engine, y_m=y_m, yaw_deg=yaw_deg))
                reading_off.append(theirs - ours)
                rays = slice(0, bench.tof.rays)
                one = closed_form(arena).cast(recorder.origins[rays], recorder.ends[rays])
                two = engine.cast(recorder.origins[rays], recorder.ends[rays])
                same = one.surface == two.surface
                length_mm = 1e3 * np.linalg.norm(recorder.ends[rays] - recorder.origins[rays], axis=1)
                ray_off += (length_mm * (two.fraction - one.fraction))[same].tolist()
                other += int((~same).sum())
    return EngineCheck(
        scene=scene,
        places=len(reading_off),
        rays=len(ray_off) + other,
        largest_ray_mm=float(np.abs(ray_off).max()),
        rms_ray_mm=float(np.sqrt(np.mean(np.square(ray_off)))),
        other_board=other,
        largest_reading_mm=float(np.abs(reading_off).max()),
    )


def checks_of(found: tuple[EngineCheck, ...]) -> list[Check]:
    limits = (PLANE_WITHIN_MM, EDGE_WITHIN_MM)
    return [
        Check(
            f"PyBullet's rays, {check.scene}",
            check.largest_reading_mm <= limit,
            f"readings at most {check.largest_reading_mm:.3f} mm apart in {check.places} places; of {check.rays} rays "
            f"{check.other_board} meet another board, the rest differ by {check.rms_ray_mm:.3f} mm rms",
            f"{limit} mm",
        )
        for check, limit in zip(found, limits, strict=True)
    ]
