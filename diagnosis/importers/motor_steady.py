"""Steady states of a motor on a bench: voltage, current and speed in sweeps (a measured case)."""

from diagnosis.importers.case import case_importer
from diagnosis.importers.motor_scale import motor_scale_notes
from diagnosis.importers.trials import KnownNoise
from diagnosis.measured.measurement import CaseKind
from diagnosis.measured.nominal import Nominal, NominalSteady
from symolo.core.table import CsvTable


def _noise(nominal: Nominal, table: CsvTable, name: str) -> KnownNoise | None:
    if not isinstance(nominal, NominalSteady) or name == "u_cmd_V":
        return None
    noise = nominal.noise
    return KnownNoise.constant(noise.current_A if name == "current_A" else noise.omega_rad_s, table)


IMPORTER = case_importer(
    CaseKind.MOTOR_STEADY, "measured case: steady states of a motor (nominal.yaml, data.csv)", _noise, motor_scale_notes
)
