"""Readings of a range sensor at known distances, materials, angles, temperatures and light (a measured case)."""

from collections.abc import Sequence

import numpy as np

from diagnosis.importers.cases.case import case_importer, scale_note
from diagnosis.importers.cases.trials import KnownNoise
from diagnosis.measured.case_files.nominal import NOMINAL, NominalTof
from diagnosis.measured.channel import SampleQuality
from diagnosis.measured.measurement import CaseKind, Measurement
from symolo.core.errors import InputError, nearest
from symolo.core.tables.table import CsvTable


def _noise(nominal: NominalTof, table: CsvTable, name: str) -> KnownNoise | None:
    if name != "reading_m":
        return None
    known = tuple(nominal.tof.reflectance)
    for i, material in enumerate(table.words["material"]):
        if material and material not in known:
            raise InputError(
                "column material",
                where=table.where(i),
                got=material,
                allowed=f"one of {', '.join(known)}",
                nearest=nearest(material, known),
                cure="or give its reflectance in nominal.yaml",
            )
    distance_m = table.numbers["distance_m"]
    nominal.noise.check(distance_m, field="noise.polynomial_mm", where=str(table.path.with_name(NOMINAL)))
    return KnownNoise(nominal.noise.sd_m(distance_m))


def _notes(_nominal: NominalTof, measurement: Measurement) -> Sequence[str]:
    (trial,) = measurement.trials
    reading, distance = trial["reading_m"], trial["distance_m"].values
    usable = (reading.quality == SampleQuality.GOOD) & (distance > 0.0)
    ratio = float(np.median(reading.values[usable] / distance[usable])) if usable.any() else float("nan")
    return scale_note(ratio, "reading_m", "m", "the distance")


IMPORTER = case_importer(CaseKind.TOF_BENCH, NominalTof, _noise, _notes)
