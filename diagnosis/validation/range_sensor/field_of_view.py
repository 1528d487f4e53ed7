"""Experiment 5: width of the spot on a board (paper Fig. 19)."""

from dataclasses import replace

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.validation.experiment import ExperimentResult, ValidationCheck
from diagnosis.validation.panels import Curve, Panel
from diagnosis.validation.range_sensor.paper import FIELD_OF_VIEW_MM, footprint_mm
from diagnosis.validation.range_sensor.stand import HEIGHT_M, SensorOnStand, target
from diagnosis.validation.still_world import RayRecorder
from symolo.pages.plotting import BLACK, VERMILION

TOLERANCE = 0.05


def field_of_view(robot: RobotConfig, seed: int) -> ExperimentResult:
    """Return the diameter of the spot on a board at each of the paper's distances."""
    mounted = SensorOnStand.from_robot(robot, seed)
    tables = {f"{distance_mm:g} mm": spot(mounted, distance_mm) for distance_mm in FIELD_OF_VIEW_MM}
    ours, paper = (np.array([table[name] for table in tables.values()]) for name in ("diameter_mm", "paper_mm"))
    checks = [
        ValidationCheck(f"diameter at {name}", table["diameter_mm"] / table["paper_mm"], 1.0, TOLERANCE, "2 d tan 12.5")
        for name, table in tables.items()
    ]
    curves = (
        Curve(FIELD_OF_VIEW_MM, paper, "paper: 2 d tan 12.5°", BLACK, "o", size=8),
        Curve(FIELD_OF_VIEW_MM, ours, "simulated, outermost ray", VERMILION, "x-"),
    )
    panel = Panel("5  Field of view", "distance [mm]", "diameter [mm]", curves, y_range=(0.0, None))
    return ExperimentResult(tables, checks, (panel,))


def spot(mounted: SensorOnStand, distance_mm: float) -> dict:
    """Return where the rays of one sensor meet a board, relative to its axis, and the diameter of that spot."""
    scene = mounted.facing(target(1e-3 * distance_mm), "field of view", distance_mm)
    recorder = RayRecorder(scene.caster)
    replace(scene, caster=recorder).reading_mm()
    points = recorder.points()[: mounted.tof.rays]
    y, z = 1e3 * points[:, 1], 1e3 * (points[:, 2] - HEIGHT_M)
    return {
        "diameter_mm": 2.0 * float(np.hypot(y, z).max()),
        "paper_mm": footprint_mm(distance_mm),
        "y_mm": y,
        "z_mm": z,
    }
