"""What the report shows beyond the diagnosis itself: each effect taken away in turn, gains by quantity, signatures."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.against import Against, against
from diagnosis.diagnose import Diagnosis
from diagnosis.engine.gain import ByEngines, by_engines
from diagnosis.extended_robot import ExtendedRobot, extended_robot
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fit import Fit, fits
from diagnosis.inference.gain import Gain, gain, of_quantity
from diagnosis.inference.hypothesis import moved
from diagnosis.inference.profile import Interval, profiles
from diagnosis.inference.unexplained.adequacy import LEVEL, Structure, adequacy
from diagnosis.measured.measurement import Measurement
from diagnosis.report.bench_rows import on_rows
from diagnosis.report.run_ends import run_ends
from diagnosis.report.signatures import Signatures, signatures
from symolo.core.arrays import Array


@dataclass(frozen=True)
class Without:
    """The extended model without one of its effects, everything else fitted anew."""

    name: str
    fit: Fit
    rise: float
    """Of the cost."""
    gain: Gain | None
    """Over the nominal robot, of what is left."""
    adds: Gain | None
    """What the effect adds: of the extended model over the one without it, on the same rows drawn anew."""


@dataclass(frozen=True)
class QuantityGain:
    name: str
    calibrated: Gain
    extended: Gain


@dataclass(frozen=True)
class Findings:
    diagnosis: Diagnosis
    robot: ExtendedRobot
    before: tuple[Structure, ...]
    """What the nominal robot with its nuisances fitted leaves, the best covariate of each observed quantity."""
    without: tuple[Without, ...]
    """Of each named effect, in their order."""
    intervals: Mapping[str, Mapping[str, tuple[Interval, ...]]]
    """By named effect and number, from the profile of the cost; of those that the data hold."""
    by_quantity: tuple[QuantityGain, ...]
    signatures: Signatures
    means: tuple[Array, Array, Array]
    """(N,) each: predicted by the nominal robot as it stands, with its nuisances fitted, and by the extended one."""
    z: tuple[Array, Array, Array]
    """(N,) each: their residuals, in sigmas of the nominal noise; NaN where not usable."""
    on_rows: tuple[str, ...] = ()
    """Sentences about single rows of a bench, or whole runs of a drive."""
    engines: ByEngines | None = None
    """By PyBullet, where it was asked for."""
    against: Against | None = None
    """A dataset held against it, where one was named."""


def findings(diagnosis: Diagnosis, *, pybullet: bool = False, release: Measurement | None = None) -> Findings:
    """All that is shown of a diagnosis.

    Args:
        diagnosis: Of a measurement.
        pybullet: Whether to ask PyBullet too, which takes up to minutes.
        release: A dataset to hold against the measurement.

    Raises:
        InputError: The dataset, or the measurement, is none of drives.
    """
    evidence, nominal = diagnosis.evidence, diagnosis.selection.nominal
    robots = (diagnosis.nominal, calibrated(diagnosis), diagnosis.extended)
    prediction = evidence.of(robots)
    usable = evidence.fit | evidence.heldout
    z = np.where(usable, (evidence.values - prediction.mean) / evidence.sd, np.nan)
    return Findings(
        diagnosis=diagnosis,
        robot=extended_robot(diagnosis),
        before=tuple(_best(evidence, nominal)),
        without=tuple(_without(diagnosis)),
        intervals=profiles(evidence, diagnosis.fit),
        by_quantity=tuple(_by_quantity(evidence, robots)),
        signatures=signatures(evidence, nominal, diagnosis.candidates.testable),
        on_rows=(*on_rows(diagnosis), *run_ends(diagnosis)),
        means=(prediction.mean[0], prediction.mean[1], prediction.mean[2]),
        z=(z[0], z[1], z[2]),
        engines=by_engines(diagnosis.measurement, diagnosis.nominal, diagnosis.extended) if pybullet else None,
        against=against(diagnosis.measurement, release, diagnosis.nominal) if release is not None else None,
    )


def calibrated(diagnosis: Diagnosis) -> RobotConfig:
    """The nominal robot with its nuisances fitted, and no effect."""
    nominal = diagnosis.selection.nominal
    return nominal.hypothesis.robot(nominal.x)


def _best(evidence: Evidence, fit: Fit) -> Iterator[Structure]:
    """Of each observed quantity, the covariate that takes most of what is left; else the one least due to chance."""
    found = adequacy(evidence, fit).structures
    for of in evidence.observed:
        own = [structure for structure in found if structure.observed == of.name]
        sure = [structure for structure in own if structure.p < LEVEL]
        if own:
            yield max(sure, key=lambda structure: structure.explainable) if sure else own[0]


def _without(diagnosis: Diagnosis) -> Iterator[Without]:
    fit, evidence = diagnosis.fit, diagnosis.evidence
    fewer = [fit.hypothesis.without(named.effect) for named in diagnosis.named]
    found = fits(evidence, [(left, moved(fit.x, fit.hypothesis, left)) for left in fewer])
    for named, left in zip(diagnosis.named, found, strict=True):
        robot = left.hypothesis.robot(left.x)
        yield Without(
            name=named.effect.name,
            fit=left,
            rise=left.cost - fit.cost,
            gain=gain(evidence, diagnosis.nominal, robot),
            adds=gain(evidence, robot, diagnosis.extended),
        )


def _by_quantity(evidence: Evidence, robots: tuple[RobotConfig, RobotConfig, RobotConfig]) -> Iterator[QuantityGain]:
    nominal, adjusted, extended = robots
    for of, place in zip(evidence.observed, evidence.places, strict=True):
        alone = of_quantity(evidence, place)
        was, has = gain(alone, nominal, adjusted), gain(alone, nominal, extended)
        if was is not None and has is not None:
            yield QuantityGain(of.name, was, has)
