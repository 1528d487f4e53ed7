"""Errors on held-out rows in physical units, of the nominal and the extended robot, in PyBullet and in the twin."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.engine.base import DRIVERS, PYBULLET, TWIN
from diagnosis.engine.drive import DrivenPath, EngineDrive
from diagnosis.engine.motor import MotorOnBench
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.gain import Gain, evidence_of_quantity, gain_of, trimmed_rms
from diagnosis.measured.measurement import CaseKind, Measurement
from diagnosis.predictors import STAGES
from diagnosis.predictors.base import Stage
from diagnosis.predictors.drive_log import VOLTAGES
from symolo.core.arrays import Array
from symolo.core.errors import InputError


@dataclass(frozen=True)
class EngineError:
    """Errors of one observed quantity in one engine."""

    quantity: str
    unit: str
    before: float
    """Root mean square error of the nominal robot over the held-out rows, without the largest 3 %, in `unit`."""
    after: float
    """Root mean square error of the extended robot over the same rows, in `unit`."""
    gain: Gain


@dataclass(frozen=True)
class EngineGain:
    """Gains in one engine."""

    engine: str
    whole: Gain
    errors: tuple[EngineError, ...]


@dataclass(frozen=True)
class EngineComparison:
    """Comparison of both robots in PyBullet and in the twin."""

    engines: tuple[EngineGain, ...]
    """Results of PyBullet and of the twin."""
    apart: tuple[tuple[str, str, float], ...]
    """Name and unit of each quantity, and root mean square difference of PyBullet and twin for the extended robot."""
    path: DrivenPath | None = None
    """Paths of a drive in PyBullet."""
    why_not: str = ""
    """Why there is no result; empty if there is one."""


def compare_engines(measurement: Measurement, nominal: RobotConfig, extended: RobotConfig) -> EngineComparison:
    """Simulate the held-out rows of a measurement from its voltages, with both robots and both engines."""
    if why_not := _why_not(measurement):
        return EngineComparison((), (), why_not=why_not)
    gains, extended_means, path = [], [], None
    for engine, stage in _engines(measurement, nominal):
        evidence = Evidence([stage]).as_measured()
        try:
            mean = evidence.predicted([nominal, extended]).mean
        except InputError as error:
            return EngineComparison((), (), why_not=str(error))
        whole = gain_of(evidence, mean)
        if whole is None:
            return EngineComparison((), (), why_not="no row that is held out can be predicted")
        gains.append(EngineGain(engine, whole, tuple(_errors(evidence, mean))))
        extended_means.append((evidence, mean[1]))
        if engine == PYBULLET and isinstance(stage, EngineDrive):
            path = stage.path(nominal, extended)
    return EngineComparison(tuple(gains), tuple(_apart(*extended_means)), path)


def _why_not(measurement: Measurement) -> str:
    if measurement.cases:
        return "several cases were fitted together; diagnose one of them to simulate it with the engine"
    if measurement.kind in {CaseKind.TOF_BENCH, CaseKind.RANGE_SCAN}:
        return "nothing moves before a range sensor on a bench, and a ray has the same length in every engine"
    if measurement.kind is CaseKind.DRIVE_LOG and not set(VOLTAGES) <= set(measurement.channel_names()):
        return "no voltages were logged that could drive a robot"
    return "" if measurement.heldout_rows else "no row is held out"


def _engines(measurement: Measurement, nominal: RobotConfig) -> Iterator[tuple[str, Stage]]:
    if measurement.kind is CaseKind.DRIVE_LOG:
        yield from ((name, EngineDrive(measurement, nominal, driver)) for name, driver in DRIVERS.items())
        return
    yield PYBULLET, MotorOnBench(measurement, nominal)
    (stage,) = STAGES[measurement.kind](measurement, nominal)
    yield TWIN, stage


def _errors(evidence: Evidence, mean: Array) -> Iterator[EngineError]:
    for observed, place in zip(evidence.observed, evidence.places, strict=True):
        gain = gain_of(evidence_of_quantity(evidence, place), mean)
        if gain is not None:
            before, after = np.abs(evidence.values[place] - mean[:, place])[:, evidence.heldout[place]]
            yield EngineError(observed.name, observed.unit, trimmed_rms(before), trimmed_rms(after), gain)


def _apart(pybullet: tuple[Evidence, Array], twin: tuple[Evidence, Array]) -> Iterator[tuple[str, str, float]]:
    evidence, mean = pybullet
    for observed, place in zip(evidence.observed, evidence.places, strict=True):
        rows = evidence.heldout[place]
        if rows.any():
            yield observed.name, observed.unit, trimmed_rms(np.abs(mean - twin[1])[place][rows])
