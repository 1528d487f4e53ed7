"""Stages of the simulator driven by measured inputs; one file per member, one line here for each."""

from collections.abc import Mapping
from types import MappingProxyType

from diagnosis.measured.measurement import Kind
from diagnosis.stages.base import Stage
from diagnosis.stages.motor_steady import predict_motor_steady
from diagnosis.stages.motor_step import predict_motor_step

STAGES: Mapping[Kind, tuple[Stage, ...]] = MappingProxyType(
    {Kind.MOTOR_STEADY: (predict_motor_steady,), Kind.MOTOR_STEP: (predict_motor_step,)}
)
"""Of each kind of measurement that can be predicted, along the signal chain."""
