"""Experiment 3: across the edge of a box of 106 mm, at six distances (paper Fig. 17)."""

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.validation.experiment import ExperimentResult, ValidationCheck
from diagnosis.validation.measures import first_reached
from diagnosis.validation.panels import COLORS, DASHES, Curve, Panel
from diagnosis.validation.range_sensor.paper import DISTANCES_MM, STEP_HEIGHT_MM, footprint_mm
from diagnosis.validation.range_sensor.stand import TARGET_HALF_WIDTH_M, SensorOnStand, arena_of, board, grid
from sensors.ranging.tof import log_error_m
from symolo.arena.geometry import Arena
from symolo.core.arrays import Array
from symolo.pages.plotting import BLACK, BLUE, SKY, VERMILION

EDGE_MM = 150.0
"""Place of the edge on the path from 0 to 300 mm."""
TOLERANCE = 0.10
"""Largest relative difference of the width from the footprint."""
EVEN_DISC = 0.687
"""10-90 % width of an evenly lit disc, in diameters."""


def step(robot: RobotConfig, seed: int) -> ExperimentResult:
    """Return scans across the edge of the box at each of the paper's distances, with and without noise."""
    mounted = SensorOnStand.from_robot(robot, seed)
    scans = {f"{distance_mm:g} mm": scan(mounted, distance_mm) for distance_mm in DISTANCES_MM}
    far, far_mm = list(scans.values())[-1], DISTANCES_MM[-1]
    equation_mm = 1e3 * float(log_error_m(np.array([1e-3 * far_mm]))[0])
    note = (
        f"the reading of a board at {far_mm:.0f} mm differs by {far['before_mm'] - far_mm:+.1f} mm. Eq. 24 with its "
        f"zero at 0.18 m gives {equation_mm:+.1f} mm there, and the robot uses {mounted.tof.error_scale:g} of it. The "
        "paper calls the readings of experiments 3 and 4 close to the distance, without a figure"
    )
    return ExperimentResult(scans, checks_of(scans), _panels(scans), (note,))


def step_arena(distance_mm: float) -> Arena:
    """Return the box at this distance before a table; the sensor moves along y, over the box while y < 0."""
    near, far = 1e-3 * distance_mm, 1e-3 * (distance_mm + STEP_HEIGHT_MM)
    box = board("box", near, 0.0, thickness_m=1e-3 * STEP_HEIGHT_MM)
    return arena_of(box, board("table", far, TARGET_HALF_WIDTH_M))


def scan(mounted: SensorOnStand, distance_mm: float) -> dict:
    """Return one path across the edge: readings as configured and without noise, and the widths of the step."""
    arena = step_arena(distance_mm)
    configured = mounted.facing(arena, "step", distance_mm)
    noiseless = mounted.without_noise().facing(arena, "step", distance_mm)
    positions = grid(0.0, 300.0, 1.0)
    places_m = (1e-3 * (positions - EDGE_MM)).tolist()
    exact = np.array([noiseless.seen_mm(distance_mm + STEP_HEIGHT_MM, y_m) for y_m in places_m])
    low, start, middle, end, high = places_of_shares(positions, exact, (0.01, 0.1, 0.5, 0.9, 0.99))
    return {
        "distance_mm": distance_mm,
        "position_mm": positions,
        "reading_mm": np.array([configured.reading_mm(y_m) for y_m in places_m]),
        "noiseless_mm": exact,
        "before_mm": float(exact[0]),
        "after_mm": float(exact[-1]),
        "width_10_90_mm": end - start,
        "width_1_99_mm": high - low,
        "middle_from_edge_mm": middle - EDGE_MM,
        "footprint_mm": footprint_mm(distance_mm),
    }


def places_of_shares(position: Array, reading: Array, shares: tuple[float, ...]) -> tuple[float, ...]:
    """Return where a reading first has changed by each share of the difference between its first and last value."""
    change = (reading - reading[0]) / (reading[-1] - reading[0])
    return tuple(first_reached(position, change, share) for share in shares)


def checks_of(scans: dict[str, dict]) -> list[ValidationCheck]:
    """Return the checks of scans at rising distances."""
    checks = []
    for name, table in scans.items():
        share, nearly_all = (table[key] / table["footprint_mm"] for key in ("width_10_90_mm", "width_1_99_mm"))
        detail = f"an evenly lit disc has {EVEN_DISC:.2f}; the 1-99 % width is {nearly_all:.2f}"
        what = f"10-90 % width over the footprint, at {name}"
        checks.append(ValidationCheck(what, share, 1.0, TOLERANCE, "footprint 2 d tan 12.5", detail=detail))
    narrower = int(np.sum(np.diff([table["width_10_90_mm"] for table in scans.values()]) <= 0.0))
    checks.append(ValidationCheck("widths that do not grow with the distance", narrower, 0, 0, "a cone"))
    return checks


def _panels(scans: dict[str, dict]) -> tuple[Panel, Panel]:
    curves = []
    for k, (name, table) in enumerate(scans.items()):
        position, half = table["position_mm"] - EDGE_MM, 0.5 * table["footprint_mm"]
        curves += [
            Curve(position, table["reading_mm"], "", COLORS[k], ".", size=2),
            Curve(position, table["noiseless_mm"], f"at {name}", COLORS[k], DASHES[k]),
            Curve([-half, half], [table["before_mm"], table["after_mm"]], "", BLACK, "|", size=10),
        ]
    curves.append(Curve([], [], "paper: edges of 2 d tan 12.5°", BLACK, "|", size=10))
    title, axes = "3  Step of 106 mm", ("position from the edge [mm]", "reading [mm]")
    scanned = Panel(title, *axes, curves, y_range=(0.0, 640.0))
    distance, footprint, narrow, nearly_all = (
        np.array([table[name] for table in scans.values()])
        for name in ("distance_mm", "footprint_mm", "width_10_90_mm", "width_1_99_mm")
    )
    widths = (
        Curve(distance, footprint, "paper: 2 d tan 12.5°", BLACK, "o", size=8),
        Curve(distance, EVEN_DISC * footprint, "10-90 % of an evenly lit disc", SKY, ":"),
        Curve(distance, narrow, "simulated, 10-90 %", VERMILION, "x-"),
        Curve(distance, nearly_all, "simulated, 1-99 %", BLUE, "+--"),
    )
    return scanned, Panel("3  Width of the step", "distance to the box [mm]", "width [mm]", widths)
