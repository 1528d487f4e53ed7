"""Lists of units for each kind of measurement."""

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

from configs.schema.robot import RobotConfig
from diagnosis.measured.measurement import CaseKind, Measurement
from diagnosis.next_trial.library.base import Library
from diagnosis.next_trial.library.drive_log import drive_log
from diagnosis.next_trial.library.motor_steady import motor_steady
from diagnosis.next_trial.library.motor_step import motor_step
from diagnosis.next_trial.library.tof_bench import tof_bench
from diagnosis.next_trial.limits import Limits

LIBRARIES: Mapping[CaseKind, Callable[[Measurement, Limits, Sequence[RobotConfig]], Library]] = MappingProxyType(
    {
        CaseKind.MOTOR_STEADY: motor_steady,
        CaseKind.MOTOR_STEP: motor_step,
        CaseKind.TOF_BENCH: tof_bench,
        CaseKind.DRIVE_LOG: drive_log,
    }
)
"""Functions that return the units for the old data, limits and the robots of the remaining models."""
