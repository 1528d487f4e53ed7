"""Experiments 1 and 2: boards of four tones and five materials, at 100 mm and at other distances (Tables 3 and 4)."""

from collections.abc import Mapping

import numpy as np

from configs.schema.arena import SurfaceName
from configs.schema.robot import RobotConfig
from diagnosis.validation.experiment import ExperimentResult, ValidationCheck
from diagnosis.validation.measures import mean_and_sd
from diagnosis.validation.panels import COLORS, DASHES, MARKERS, Curve, Panel
from diagnosis.validation.range_sensor.paper import MEAN_WITHIN_MM, SD_WITHIN, TABLE_3, TABLE_4, PrintedReadings
from diagnosis.validation.range_sensor.stand import SensorOnStand, grid, target, valid_mm
from sensors.ranging.tof import log_error_m, noise_sd_m
from symolo.core.arrays import Array
from symolo.dataset.codes import TofStatus
from symolo.pages.plotting import BLACK, GREY, PALE, VERMILION

MIN_READINGS = 10
"""Fewest valid readings that give a distance a mean."""
MIN_JUDGED = 5000
"""Fewest valid readings that allow a verdict on Tables 3 and 4."""
SOURCES = {"tones": "Table 3", "materials": "Table 4"}
EQUATION_MM = np.linspace(40.0, 1200.0, 200)
"""Distances at which Eq. 23 and 24 are drawn."""


def tones(robot: RobotConfig, seed: int, counts: tuple[int, int]) -> ExperimentResult:
    """Return experiment 1, from 0 to 1.2 m every 10 mm (the paper took every millimetre).

    `counts` are the numbers of readings of each surface at 100 mm and at every other distance.
    """
    mounted = SensorOnStand.from_robot(robot, seed)
    result = _surfaces(mounted, "tones", TABLE_3, grid(0.0, 1200.0, 10.0), counts)
    distance, scale = EQUATION_MM, robot.tof.error_scale
    bias_mm = 1e3 * log_error_m(1e-3 * distance)
    bias = Curve(distance, bias_mm, f"Eq. 24; the robot uses {scale:g} of it", GREY, width=3)
    noise_mm = 1e3 * noise_sd_m(np.full_like(distance, 1.41e-3), 1e-3 * distance)
    noise = [Curve(distance, noise_mm, "Eq. 23, in x - 0.18 m", GREY, width=3)]
    for k, surface in enumerate(TABLE_3):
        table = result.tables[surface]
        noise.append(Curve(table["distance_mm"], table["sd_mm"], _shown(surface), COLORS[k], MARKERS[k], size=4))
    mean, *others = result.panels
    with_bias = Panel(mean.title, mean.x_label, mean.y_label, (bias, *mean.curves))
    deviation = Panel("1  Tones: deviation", "distance [mm]", "standard deviation [mm]", noise, y_range=(0.0, None))
    glass = "the offset of a surface is the same at all distances; in the paper that of glass grows with it (no figure)"
    dark = "no reading is lost in the model for lack of light: a black board is seen as far as a white one"
    tables = {**result.tables, "equation_24": {"share_in_the_robot": scale}}
    return ExperimentResult(tables, result.checks, (with_bias, deviation, *others), (glass, dark))


def materials(robot: RobotConfig, seed: int, counts: tuple[int, int]) -> ExperimentResult:
    """Return experiment 2, from 61 to 900 mm as in the paper; `counts` as for `tones`."""
    return _surfaces(SensorOnStand.from_robot(robot, seed), "materials", TABLE_4, grid(61.0, 900.0, 41.95), counts)


def _surfaces(
    mounted: SensorOnStand,
    name: str,
    printed: Mapping[SurfaceName, PrintedReadings],
    distances_mm: Array,
    counts: tuple[int, int],
) -> ExperimentResult:
    source = SOURCES[name]
    tables, checks, curves = {}, [], []
    for k, (surface, paper) in enumerate(printed.items()):
        table = at_100_mm(mounted, name, surface, paper, counts[0])
        table |= over_distance(mounted, name, surface, distances_mm, counts[1])
        tables[surface] = table
        checks += table_checks(surface, table, source)
        off = table["mean_mm"] - table["distance_mm"]
        curves.append(Curve(table["distance_mm"], off, _shown(surface), COLORS[k], DASHES[k]))
        curves.append(Curve([100.0], [paper.mean_mm - 100.0], "", COLORS[k], MARKERS[k], size=7))
    title = f"{name.capitalize()}: mean minus distance; points: paper"
    panel = Panel(title, "distance [mm]", "mean reading minus distance [mm]", curves)
    return ExperimentResult(tables, checks, (panel, *_panels_at_100_mm(tables, source)))


def at_100_mm(mounted: SensorOnStand, name: str, surface: SurfaceName, paper: PrintedReadings, count: int) -> dict:
    """Return mean and deviation of the valid readings of one surface at 100 mm, beside the paper's."""
    readings = mounted.facing(target(0.1, surface), name, surface, "at 100 mm").readings_mm(count)
    mean_mm, sd_mm = mean_and_sd(readings)
    return {
        "readings_at_100_mm": len(readings),
        "mean_at_100_mm": mean_mm,
        "sd_at_100_mm": sd_mm,
        "paper_mean_mm": paper.mean_mm,
        "paper_sd_mm": paper.sd_mm,
    }


def over_distance(
    mounted: SensorOnStand, name: str, surface: SurfaceName, distances_mm: Array, count: int
) -> dict[str, Array]:
    """Return mean and deviation at each distance, NaN below `MIN_READINGS`, and the share without a target."""
    mean, sd, without = np.full((3, len(distances_mm)), np.nan)
    for k, distance_mm in enumerate(distances_mm.tolist()):
        arena = target(max(1e-3 * distance_mm, 1e-6), surface)
        samples = mounted.facing(arena, name, surface, distance_mm).samples(count)
        valid = valid_mm(samples)
        if len(valid) >= MIN_READINGS:
            mean[k], sd[k] = mean_and_sd(valid)
        without[k] = np.mean(samples[:, 1] == TofStatus.NO_TARGET)
    return {"distance_mm": distances_mm, "mean_mm": mean, "sd_mm": sd, "without_target": without}


def table_checks(surface: str, table: Mapping, source: str) -> list[ValidationCheck]:
    """Return the checks of one row of Table 3 or 4, open where it has too few readings for a verdict."""
    count, open_ = table["readings_at_100_mm"], table["readings_at_100_mm"] < MIN_JUDGED
    detail = f"{count} readings, a verdict needs {MIN_JUDGED}" if open_ else f"{count} readings"
    mean, sd = table["paper_mean_mm"], table["paper_sd_mm"]
    rows = (("mean", mean, MEAN_WITHIN_MM), ("sd", sd, SD_WITHIN * sd))
    return [
        ValidationCheck(
            f"{name} of {surface} at 100 mm", table[f"{name}_at_100_mm"], paper, tolerance, source, "mm", detail, open_
        )
        for name, paper, tolerance in rows
    ]


def _panels_at_100_mm(tables: Mapping[str, Mapping], source: str) -> list[Panel]:
    places, names = np.arange(len(tables)), [_shown(surface) for surface in tables]
    panels = []
    for what, name in (("Mean", "mean"), ("Deviation", "sd")):
        ours, paper = (
            np.array([table[key] for table in tables.values()]) for key in (f"{name}_at_100_mm", f"paper_{name}_mm")
        )
        within = np.full(len(paper), MEAN_WITHIN_MM) if name == "mean" else SD_WITHIN * paper
        curves = (
            Curve(places, paper + within, "allowed", PALE, kind="bars", base=paper - within),
            Curve(places, paper, f"printed, {source}", BLACK, "o", size=8),
            Curve(places, ours, "simulated", VERMILION, "x", size=8),
        )
        panels.append(Panel(f"{source}: {what.lower()} at 100 mm", "", f"{what.lower()} [mm]", curves, x_names=names))
    return panels


def _shown(surface: str) -> str:
    return surface.replace("_board", "").replace("_", " ")
