"""Experiments 1 and 2: boards of four tones and five materials, at 100 mm and over the distance (Tables 3 and 4)."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from configs.schema.arena import SurfaceName
from diagnosis.validation.range_sensor.check import Check
from diagnosis.validation.range_sensor.paper import MEAN_WITHIN_MM, SD_WITHIN, TABLE_3, TABLE_4, Printed
from diagnosis.validation.range_sensor.stand import Bench, Stand, closed_form, grid, target, valid_mm
from symolo.core.arrays import Array
from symolo.dataset.codes import TofStatus

FEWEST = 10
"""Valid readings below which a distance has no mean."""
FEWEST_JUDGED = 5000
"""Valid readings below which Tables 3 and 4 neither hold nor are missed."""


@dataclass(frozen=True)
class AtHundred:
    """Readings of one surface at 100 mm."""

    surface: str
    readings: int
    """Valid ones."""
    mean_mm: float
    sd_mm: float
    paper_mean_mm: float
    paper_sd_mm: float

    @property
    def holds(self) -> bool:
        mean_off = abs(self.mean_mm - self.paper_mean_mm)
        return mean_off <= MEAN_WITHIN_MM and abs(self.sd_mm / self.paper_sd_mm - 1.0) <= SD_WITHIN


@dataclass(frozen=True)
class OverDistance:
    """Mean and deviation over the distance; None where fewer than `FEWEST` readings found a target."""

    surface: str
    distance_mm: tuple[float, ...]
    mean_mm: tuple[float | None, ...]
    sd_mm: tuple[float | None, ...]
    without_target: tuple[float, ...]
    """Share of the readings that say so."""


@dataclass(frozen=True)
class Surfaces:
    table: tuple[AtHundred, ...]
    curves: tuple[OverDistance, ...]


@dataclass(frozen=True)
class Counts:
    """How many readings are taken."""

    at_hundred: int
    """Of each surface at 100 mm."""
    per_distance: int


def tones(bench: Bench, counts: Counts) -> Surfaces:
    """Experiment 1: 0 to 1.2 m (every 10 mm; the paper took every millimetre)."""
    return _surfaces(bench, "tones", TABLE_3, grid(0.0, 1200.0, 10.0), counts)


def materials(bench: Bench, counts: Counts) -> Surfaces:
    """Experiment 2: 61 to 900 mm, as in the paper."""
    return _surfaces(bench, "materials", TABLE_4, grid(61.0, 900.0, 41.95), counts)


def _surfaces(
    bench: Bench, name: str, printed: Mapping[SurfaceName, Printed], distances_mm: Array, counts: Counts
) -> Surfaces:
    return Surfaces(
        table=tuple(_at_hundred(bench, name, surface, paper, counts) for surface, paper in printed.items()),
        curves=tuple(_curve(bench, name, surface, distances_mm, counts) for surface in printed),
    )


def _at_hundred(bench: Bench, name: str, surface: SurfaceName, paper: Printed, counts: Counts) -> AtHundred:
    arena = target(0.1, surface)
    found = bench.readings_mm(
        bench.sensor(arena, name, surface, "at 100 mm"), Stand(closed_form(arena)), counts.at_hundred
    )
    return AtHundred(
        surface=surface,
        readings=len(found),
        mean_mm=float(found.mean()),
        sd_mm=float(found.std(ddof=1)),
        paper_mean_mm=paper.mean_mm,
        paper_sd_mm=paper.sd_mm,
    )


def _curve(bench: Bench, name: str, surface: SurfaceName, distances_mm: Array, counts: Counts) -> OverDistance:
    mean: list[float | None] = []
    sd: list[float | None] = []
    without: list[float] = []
    for distance_mm in distances_mm.tolist():
        arena = target(max(1e-3 * distance_mm, 1e-6), surface)
        sensor = bench.sensor(arena, name, surface, distance_mm)
        samples = bench.samples(sensor, Stand(closed_form(arena)), counts.per_distance)
        found = valid_mm(samples)
        enough = len(found) >= FEWEST
        mean.append(float(found.mean()) if enough else None)
        sd.append(float(found.std(ddof=1)) if enough else None)
        without.append(float(np.mean(samples[:, 1] == TofStatus.NO_TARGET)))
    return OverDistance(surface, tuple(distances_mm.tolist()), tuple(mean), tuple(sd), tuple(without))


def checks_of(surfaces: Surfaces, table: int) -> list[Check]:
    """Whether every row of Table 3 or 4 comes out; open where a row has too few readings to say."""
    off = max(surfaces.table, key=lambda row: abs(row.mean_mm - row.paper_mean_mm))
    wide = max(surfaces.table, key=lambda row: abs(row.sd_mm / row.paper_sd_mm - 1.0))
    fewest = min(row.readings for row in surfaces.table)
    found = (
        f"mean at most {off.mean_mm - off.paper_mean_mm:+.2f} mm off ({off.surface}), deviation at most "
        f"{100 * (wide.sd_mm / wide.paper_sd_mm - 1.0):+.1f} % ({wide.surface}), {fewest} readings each"
    )
    wanted = f"within {MEAN_WITHIN_MM} mm and {100 * SD_WITHIN:.0f} %, of {FEWEST_JUDGED} readings or more"
    holds = all(row.holds for row in surfaces.table) if fewest >= FEWEST_JUDGED else None
    return [Check(f"Table {table}", holds, found, wanted)]
