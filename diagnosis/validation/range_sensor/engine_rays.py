"""The same sensor with the rays of PyBullet: how far its readings are from those with the rays of the simulation."""

from dataclasses import replace

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.validation.experiment import ExperimentResult, ValidationCheck
from diagnosis.validation.measures import rms
from diagnosis.validation.range_sensor.paper import DISTANCES_MM
from diagnosis.validation.range_sensor.stand import SensorOnStand, grid, target
from diagnosis.validation.range_sensor.step import step_arena
from diagnosis.validation.still_world import RayRecorder
from physics.bullet.ray_oracle import EngineRays
from symolo.arena.geometry import Arena

PLANE_TOLERANCE_MM = 0.1
EDGE_TOLERANCE_MM = 5.0
"""Largest difference at an edge, which the engine rounds, so that a ray may hit another board."""
Place = tuple[float, float]
"""Lateral position y [m] and yaw [deg] of the sensor."""


def engine_rays(robot: RobotConfig, seed: int) -> ExperimentResult:
    """Return noiseless readings of boards at several angles, and across the step, with both kinds of rays."""
    noiseless = SensorOnStand.from_robot(robot, seed).without_noise()
    plane: list[tuple[Arena, list[Place]]] = []
    edge: list[tuple[Arena, list[Place]]] = []
    for distance_mm in DISTANCES_MM:
        plane.append((target(1e-3 * distance_mm), [(0.0, angle) for angle in grid(-25.0, 25.0, 5.0).tolist()]))
        edge.append((step_arena(distance_mm), [(1e-3 * y, 0.0) for y in grid(-150.0, 150.0, 5.0).tolist()]))
    tables, checks = {}, []
    for scene, stations, tolerance in (("board, tilted", plane, PLANE_TOLERANCE_MM), ("step", edge, EDGE_TOLERANCE_MM)):
        table = _compared(noiseless, scene, stations)
        tables[scene] = table
        detail = f"{table['places']} places; {table['other_board']} of {table['rays']} rays meet another board"
        name, value = f"largest difference of a reading, {scene}", table["largest_reading_mm"]
        checks.append(ValidationCheck(name, value, 0.0, tolerance, "PyBullet's rays", "mm", detail))
    return ExperimentResult(tables, checks)


def _compared(mounted: SensorOnStand, scene: str, stations: list[tuple[Arena, list[Place]]]) -> dict:
    reading_off, ray_off, other = [], [], 0
    rays = slice(0, mounted.tof.rays)
    for arena, places in stations:
        closed_form = mounted.facing(arena, "engine", scene)
        recorder = RayRecorder(closed_form.caster)
        with EngineRays(arena) as engine:
            for y_m, yaw_deg in places:
                ours = replace(closed_form, caster=recorder).reading_mm(y_m, yaw_deg)
                theirs = replace(closed_form, caster=engine).reading_mm(y_m, yaw_deg)
                reading_off.append(theirs - ours)
                origins, ends = recorder.origins[rays], recorder.ends[rays]
                one, two = closed_form.caster.cast(origins, ends), engine.cast(origins, ends)
                # Lengths are compared for rays that meet the same board on both sides.
                same = one.surface == two.surface
                length_mm = 1e3 * np.linalg.norm(ends - origins, axis=1)
                ray_off += (length_mm * (two.fraction - one.fraction))[same].tolist()
                other += int((~same).sum())
    return {
        "places": len(reading_off),
        "rays": len(ray_off) + other,
        "largest_ray_mm": float(np.abs(ray_off).max()),
        "rms_ray_mm": rms(np.array(ray_off)),
        "other_board": other,
        "largest_reading_mm": float(np.abs(reading_off).max()),
    }
