"""Stages of the simulator with measured inputs: one file, and one line here, for each kind of measurement."""

from collections.abc import Mapping
from types import MappingProxyType

from diagnosis.measured.measurement import CaseKind
from diagnosis.predictors.base import Binder, only_stage
from diagnosis.predictors.drive_log import drive_log_stages
from diagnosis.predictors.motor.steady import MotorSteady
from diagnosis.predictors.motor.step import MotorStep
from diagnosis.predictors.ranges.range_scan import RangeScan
from diagnosis.predictors.ranges.tof_bench import TofBenchStage
from diagnosis.predictors.symolo_csv import symolo_csv_stages

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
