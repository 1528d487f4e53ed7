"""Stages of the simulator with measured inputs; one file and one line here for each kind of measurement."""

from collections.abc import Mapping
from types import MappingProxyType

from diagnosis.measured.measurement import CaseKind
from diagnosis.predictors.base import Binder
from diagnosis.predictors.drive_log import drive_log_stages
from diagnosis.predictors.motor_steady import motor_steady_stages
from diagnosis.predictors.motor_step import motor_step_stages
from diagnosis.predictors.tof_bench import tof_bench_stages

STAGES: Mapping[CaseKind, Binder] = MappingProxyType(
    {
        CaseKind.MOTOR_STEADY: motor_steady_stages,
        CaseKind.MOTOR_STEP: motor_step_stages,
        CaseKind.TOF_BENCH: tof_bench_stages,
        CaseKind.DRIVE_LOG: drive_log_stages,
    }
)
"""Stages of each kind of measurement that can be predicted."""
