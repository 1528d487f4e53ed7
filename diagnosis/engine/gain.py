"""Errors on held-out rows in physical units, before and after, by PyBullet and beside it by the twin."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.engine.base import DRIVERS, PYBULLET, TWIN
from diagnosis.engine.drive import DrivenPath, EngineDrive
from diagnosis.engine.motor import MotorOnBench
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.gain import Gain, gain_of, of_quantity, trimmed_rms
from diagnosis.measured.measurement import CaseKind, Measurement
from diagnosis.predictors import STAGES
from diagnosis.predictors.base import Stage
from diagnosis.predictors.drive_log import VOLTAGES
from symolo.core.arrays import Array
from symolo.core.errors import InputError


@dataclass(frozen=True)
class EngineError:
    """Of one observed quantity by one engine."""

    quantity: str
    unit: str
    before: float
    """Root mean square over the held-out rows, without the largest 3 %, by the nominal robot, in `unit`."""
    after: float
    """By the extended robot."""
    gain: Gain


@dataclass(frozen=True)
class EngineGain:
    """Of one engine."""

    engine: str
    whole: Gain
    errors: tuple[EngineError, ...]


@dataclass(frozen=True)
class EngineComparison:
    """What PyBullet says of the extended robot."""

    engines: tuple[EngineGain, ...]
    """PyBullet and the twin."""
    apart: tuple[tuple[str, str, float], ...]
    """Of each quantity its unit, and how far PyBullet and twin are apart by the extended robot, root mean square."""
    path: DrivenPath | None = None
    """Of a drive, by PyBullet."""
    why_not: str = ""
    """Why there is nothing; empty where there is."""


def compare_engines(measurement: Measurement, nominal: RobotConfig, extended: RobotConfig) -> EngineComparison:
    """Held-out rows of a measurement, from its voltages on, by both robots and both engines."""
    if why_not := _why_not(measurement):
        return EngineComparison((), (), why_not=why_not)
    found, of_extended, path = [], [], None
    for engine, stage in _engines(measurement, nominal):
        evidence = Evidence([stage])
        try:
            mean = evidence.of([nominal, extended]).mean
        except InputError as error:
            return EngineComparison((), (), why_not=str(error))
        whole = gain_of(evidence, mean)
        if whole is None:
            return EngineComparison((), (), why_not="no row that is held out can be predicted")
        found.append(EngineGain(engine, whole, tuple(_errors(evidence, mean))))
        of_extended.append((evidence, mean[1]))
        if engine == PYBULLET and isinstance(stage, EngineDrive):
            path = stage.path(nominal, extended)
    return EngineComparison(tuple(found), tuple(_apart(*of_extended)), path)


def _why_not(measurement: Measurement) -> str:
    if measurement.kind is CaseKind.TOF_BENCH:
        return "nothing moves on a range bench, and its bare ray to a flat target is as long in every engine"
    if measurement.kind is CaseKind.DRIVE_LOG and not set(VOLTAGES) <= set(measurement.channel_names()):
        return "no voltages were logged, by which a robot could be driven"
    return "" if measurement.heldout_rows else "no row is held out"


def _engines(measurement: Measurement, nominal: RobotConfig) -> Iterator[tuple[str, Stage]]:
    if measurement.kind is CaseKind.DRIVE_LOG:
        yield from ((name, EngineDrive(measurement, nominal, driver)) for name, driver in DRIVERS.items())
        return
    yield PYBULLET, MotorOnBench(measurement, nominal)
    (stage,) = STAGES[measurement.kind](measurement, nominal)
    yield TWIN, stage


def _errors(evidence: Evidence, mean: Array) -> Iterator[EngineError]:
    for of, place in zip(evidence.observed, evidence.places, strict=True):
        found = gain_of(of_quantity(evidence, place), mean)
        if found is not None:
            rows = evidence.heldout[place]
            before, after = np.abs(evidence.values[place] - mean[:, place])[:, rows]
            yield EngineError(of.name, of.unit, trimmed_rms(before), trimmed_rms(after), found)


def _apart(pybullet: tuple[Evidence, Array], twin: tuple[Evidence, Array]) -> Iterator[tuple[str, str, float]]:
    evidence, mean = pybullet
    for of, place in zip(evidence.observed, evidence.places, strict=True):
        rows = evidence.heldout[place]
        if rows.any():
            yield of.name, of.unit, trimmed_rms(np.abs(mean - twin[1])[place][rows])
