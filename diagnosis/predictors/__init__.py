"""Stages of the simulator with measured inputs: one file, and one line here, for each kind of measurement."""

from collections.abc import Mapping
from types import MappingProxyType

from diagnosis.measured.measurement import CaseKind, Measurement
from diagnosis.predictors.base import Binder, only_stage
from diagnosis.predictors.drive_log import drive_log_stages
from diagnosis.predictors.motor.steady import MotorSteady
from diagnosis.predictors.motor.step import MotorStep
from diagnosis.predictors.ranges.range_scan import RangeScan
from diagnosis.predictors.ranges.tof_bench import TofBenchStage
from diagnosis.predictors.symolo_csv import symolo_csv_stages
from symolo.core.errors import InputError

STAGES: Mapping[CaseKind, Binder] = MappingProxyType(
    {
        CaseKind.MOTOR_STEADY: only_stage(MotorSteady),
        CaseKind.MOTOR_STEP: only_stage(MotorStep),
        CaseKind.TOF_BENCH: only_stage(TofBenchStage),
        CaseKind.RANGE_SCAN: only_stage(RangeScan),
        CaseKind.DRIVE_LOG: drive_log_stages,
        CaseKind.SYMOLO_CSV: symolo_csv_stages,
    }
)
"""Stages of each kind of measurement that can be predicted."""


def check_kind(measurement: Measurement) -> None:
    """Raise InputError if no stage of the simulator predicts such data."""
    if measurement.kind not in STAGES and not measurement.cases:
        allowed = ", ".join(STAGES)
        what = f"data of kind {measurement.kind} cannot be compared with a simulation"
        cure = (
            "diagnose a bench or a drive; `symolo inspect` shows what these data contain, and `symolo case init` makes "
            "a case of a log"
        )
        raise InputError(what, where=measurement.where, allowed=allowed, cure=cure)
