"""Voltage, current and speed of a motor against time, in trials from rest (a measured case)."""

from collections.abc import Sequence

import numpy as np

from diagnosis.importers.cases.case import case_importer
from diagnosis.importers.cases.motor_case import motor_noise, motor_notes
from diagnosis.measured.case_files.nominal import NominalStep
from diagnosis.measured.measurement import CaseKind, Measurement
from symolo.core.errors import InputError


def _notes(nominal: NominalStep, measurement: Measurement) -> Sequence[str]:
    check_rate(measurement, 1.0 / nominal.sample_rate_Hz)
    return motor_notes(nominal, measurement)


def check_rate(measurement: Measurement, period_s: float) -> None:
    """Refuse rows that are not about one period apart.

    Raises:
        InputError: The median step is longer than two periods or shorter than half of one.
    """
    steps = np.concatenate([np.diff(trial.t_s) for trial in measurement.trials])
    typical_s = float(np.median(steps)) if len(steps) else period_s
    if not 0.5 <= typical_s / period_s <= 2.0:
        factor = typical_s / period_s
        cure = "these look like ms: divide by 1000" if 500.0 < factor < 2000.0 else "check the unit of the times"
        raise InputError(
            f"column t_s: rows are {typical_s:.4g} s apart",
            where=measurement.source.files[0],
            allowed=f"about {period_s:.4g} s, by the rate of this kind of case",
            cure=cure,
        )


IMPORTER = case_importer(CaseKind.MOTOR_STEP, NominalStep, motor_noise, _notes)
