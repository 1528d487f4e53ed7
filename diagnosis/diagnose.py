"""The whole diagnosis of one measurement: what is wrong, how sure that is, what stays open, and what it gains."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from math import isfinite

import numpy as np

from configs.draw import draw_robot
from configs.loader import load_section
from configs.schema.robot import RobotConfig
from diagnosis.inference.candidates import Candidates, candidates
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.evidence.noise_level import combined, found_noises, is_open
from diagnosis.inference.evidence.rounding import with_shared_rounding
from diagnosis.inference.evidence.whole_runs import fitted_to_whole_runs
from diagnosis.inference.fit import Fit, at, fits
from diagnosis.inference.gain import Gain, gain
from diagnosis.inference.hypothesis import CandidateEffect, Hypothesis, moved
from diagnosis.inference.rivals import RivalComparison, compare_rivals
from diagnosis.inference.selection import Selection, is_of_noise, rescued, select
from diagnosis.inference.unexplained.adequacy import Adequacy, Structure, adequacy, survivors
from diagnosis.inference.unexplained.change import change_in_time
from diagnosis.inference.unexplained.locate import located
from diagnosis.inference.unexplained.scatter import with_scatter
from diagnosis.measured.measurement import Kind, Measurement
from diagnosis.measured.nominal import KnownWheels
from diagnosis.nominal_robot import nominal_robot
from diagnosis.nuisances import Nuisance, command_timing, nuisances
from diagnosis.predictors import STAGES
from diagnosis.predictors.base import Stage
from diagnosis.usual_tolerances import usual
from symolo.core.errors import InputError

CLEARLY = 0.5
"""Cost by which a rival must explain more to be named in an effect's place."""
MUCH_MORE = 1.25
"""Times that a row may turn out to be worth before effects are looked for anew."""
NOISE_ROUNDS = 2
"""Fits after which an unknown noise has settled: the first guess may be far off."""


@dataclass(frozen=True)
class NamedEffect:
    """One effect that the real robot has."""

    effect: CandidateEffect
    values: dict[str, float]
    std: dict[str, float]
    comparison: RivalComparison

    @property
    def name(self) -> str:
        return self.effect.kind.name

    @property
    def parameters(self) -> dict[str, str | float]:
        """Choices and numbers."""
        return {**dict(self.effect.choices), **self.values}


@dataclass(frozen=True)
class Diagnosis:
    measurement: Measurement
    evidence: Evidence
    nominal: RobotConfig
    candidates: Candidates
    selection: Selection
    fit: Fit
    """With the effects that are named."""
    named: tuple[NamedEffect, ...]
    withdrawn: tuple[str, ...]
    """Names that were chosen and then given up, since structure remains that they do not account for."""
    adequacy: Adequacy
    """Of the selected model, before anything was withdrawn."""
    gain: Gain | None
    """Of the extended model over the nominal one."""
    calibrated: Gain | None
    """Of the nominal model with its nuisances fitted, and no effect: plain calibration."""

    @property
    def unexplained(self) -> Structure | None:
        """What no name accounts for."""
        return None if self.adequacy.is_adequate else self.adequacy.worst

    @property
    def extended(self) -> RobotConfig:
        """The robot with its nuisances as fitted and the effects that are named."""
        return self.fit.hypothesis.robot(self.fit.x)

    def answer(self) -> dict[str, object]:
        """As GAP_FORMAT has it, ready for JSON."""
        found: dict[str, object] = {
            "effects": [
                {
                    "name": named.name,
                    "parameters": named.parameters,
                    "std": {name: std for name, std in named.std.items() if isfinite(std)},
                    "confidence": round(named.comparison.confidence, 4),
                    "ambiguous_with": list(named.comparison.ambiguous_with),
                }
                for named in self.named
            ],
            "unexplained": self.unexplained is not None,
        }
        if self.unexplained is not None:
            found["unexplained_where"] = {
                "channel": self.unexplained.channel,
                "covariate": self.unexplained.covariate,
            }
        if self.gain is not None:
            found["heldout_gain"] = self.gain.value
            found["heldout_gain_ci"] = [self.gain.low, self.gain.high]
        return found


def diagnose(measurement: Measurement, nominal: RobotConfig | None = None) -> Diagnosis:
    """What the simulation gets wrong about a measurement.

    Args:
        measurement: Of a kind that a stage predicts, with nominal parameters.
        nominal: The robot that a textbook simulation would run, in all that the measurement's own nominal parameters do
            not speak of; the shipped robot `nominal` by default.

    Raises:
        InputError: No stage of the simulator predicts such data, or nothing of it can be used.
    """
    check_kind(measurement)
    where = _where(measurement)
    robot = _nominal(measurement, nominal)
    bare = Hypothesis(robot, _spreads(measurement, robot))
    stages = STAGES[measurement.kind](measurement, robot)
    if not stages:
        cure = "log voltages and counts, counts and poses, or poses and ranges"
        raise InputError("nothing that a stage could predict from what was logged beside it", where=where, cure=cure)
    evidence = _evidence(stages, bare)
    if not evidence.fit.any():
        raise InputError("no usable sample to fit", where=where, cure="log inputs and readings in the same rows")
    library = candidates(measurement, evidence, bare)
    selection = select(evidence, bare, library.testable)
    # What lacked an effect lasted longer than its noise.
    renewed = _with_found_noises(evidence, selection.fit)
    if np.any(renewed.weight > MUCH_MORE * evidence.weight):
        evidence, selection = renewed, select(renewed, bare, library.testable, selection)
    left = adequacy(evidence, selection.fit)
    if not left.is_adequate and (better := rescued(evidence, selection.fit, library.testable)) is not None:
        selection = replace(selection, fit=better)
        left = adequacy(evidence, better)
    left = _left(evidence, selection, left)
    fit = selection.fit if left.is_adequate else _without_stand_ins(evidence, selection, left)
    standings = [compare_rivals(evidence, fit, effect, library.testable) for effect in fit.hypothesis.effects]
    if left.is_adequate:
        fit, standings = _best_named(evidence, fit, standings, library.testable)
    fit = with_shared_rounding(evidence, _over_whole_runs(measurement, evidence, fit))
    kept = {effect.name for effect in fit.hypothesis.effects}
    extended = fit.hypothesis.robot(fit.x)
    calibrated = selection.nominal.hypothesis.robot(selection.nominal.x)
    # Dozens of fits with all their slopes, for which nobody asks again.
    evidence.known.clear()
    return Diagnosis(
        measurement=measurement,
        evidence=evidence,
        nominal=robot,
        candidates=library,
        selection=selection,
        fit=fit,
        named=tuple(
            NamedEffect(of.effect, dict(fit.hypothesis.values(of.effect, fit.x)), fit.std(of.effect), of)
            for of in standings
        ),
        withdrawn=() if left.is_adequate else tuple(n for n in selection.names if n not in kept),
        adequacy=left,
        gain=gain(evidence, robot, extended),
        calibrated=gain(evidence, robot, calibrated),
    )


def _evidence(stages: Sequence[Stage], bare: Hypothesis) -> Evidence:
    """What was observed, with its noise as stated or else as the nominal model finds it."""
    evidence = Evidence(stages)
    rounds = NOISE_ROUNDS if evidence.fit.any() else 0
    for _ in range(rounds if any(is_open(of) for of in evidence.observed) else 0):
        (fit,) = fits(evidence, [(bare, bare.null())])
        evidence = _with_found_noises(evidence, fit)
    return evidence


def _with_found_noises(evidence: Evidence, fit: Fit) -> Evidence:
    return Evidence(evidence.stages, combined(evidence, found_noises(evidence, fit)))


def check_kind(measurement: Measurement) -> None:
    """Raise InputError where no stage of the simulator predicts such data."""
    if measurement.kind not in STAGES:
        allowed = ", ".join(STAGES)
        what = f"no stage predicts data of kind {measurement.kind}"
        cure = "diagnose a bench or a drive; symolo inspect tells what these data hold"
        raise InputError(what, where=_where(measurement), allowed=allowed, cure=cure)


def _where(measurement: Measurement) -> str:
    return next(iter(measurement.source.files), measurement.name)


def _nominal(measurement: Measurement, given: RobotConfig | None) -> RobotConfig:
    """The robot given, or a shipped one, with the measurement's own nominal parameters in it."""
    carrier = given or draw_robot(load_section("robot", "nominal"), 0, "diagnosis")[0]
    return carrier if measurement.nominal is None else nominal_robot(measurement.nominal, carrier)


def _spreads(measurement: Measurement, robot: RobotConfig) -> tuple[Nuisance, ...]:
    """What may differ without anything being wrong: as the measurement states it, else what is usual."""
    if measurement.nominal is not None:
        return nuisances(measurement.nominal)
    return (*usual(robot), command_timing()) if measurement.kind is Kind.DRIVE_LOG else usual(robot)


def _left(evidence: Evidence, selection: Selection, left: Adequacy) -> Adequacy:
    """All that the selected model leaves: structure, scatter, a jump in time; in the channel where it lives."""
    left = with_scatter(evidence, selection.fit, left)
    jump = change_in_time(evidence, selection.nominal, selection.fit)
    if jump is not None:
        return Adequacy((jump, *left.structures))
    return left if left.is_adequate else located(evidence, selection.nominal.hypothesis, left)


def _without_stand_ins(evidence: Evidence, selection: Selection, left: Adequacy) -> Fit:
    """The fit with only those effects that are needed beside what remains unexplained.

    Noise is not: it takes any structure of the mean for its own, and hides how large that is.
    """
    fit = selection.fit
    of_mean = [effect for effect in fit.hypothesis.effects if not is_of_noise(fit, effect)]
    if len(of_mean) < len(fit.hypothesis.effects):
        fit = _with_only(evidence, selection, fit, of_mean)
        left = _left(evidence, replace(selection, fit=fit), adequacy(evidence, fit))
    return _with_only(evidence, selection, fit, survivors(evidence, selection.nominal, fit, left.worst))


def _with_only(evidence: Evidence, selection: Selection, fit: Fit, keep: Collection[CandidateEffect]) -> Fit:
    """The fit with some of its effects."""
    kept = tuple(effect for effect in fit.hypothesis.effects if effect in keep)
    if len(kept) == len(fit.hypothesis.effects):
        return fit
    if not kept:
        return selection.nominal
    fewer = Hypothesis(fit.hypothesis.nominal, fit.hypothesis.nuisances, kept)
    (found,) = fits(evidence, [(fewer, moved(fit.x, fit.hypothesis, fewer))])
    return found


def _over_whole_runs(measurement: Measurement, evidence: Evidence, fit: Fit) -> Fit:
    """With its numbers as whole runs have them, where a drive has no commands and its runs are all it can tell by."""
    if not isinstance(measurement.nominal, KnownWheels):
        return fit
    whole = fitted_to_whole_runs(measurement, fit.hypothesis, fit.x, ())
    if whole is None:
        return fit
    return replace(at(evidence, fit.hypothesis, whole.x), information=np.linalg.pinv(whole.covariance, hermitian=True))


def _best_named(
    evidence: Evidence, fit: Fit, standings: Sequence[RivalComparison], effects: Sequence[CandidateEffect]
) -> tuple[Fit, Sequence[RivalComparison]]:
    """Where a rival turned out to explain more than a named effect, the rival is named."""
    closest = [next((rival for rival in of.rivals if not rival.refused), None) for of in standings]
    better = [rival for rival in closest if rival is not None and rival.worse < -CLEARLY]
    if not better:
        return fit, standings
    best = min(better, key=lambda rival: rival.worse).fit
    return best, [compare_rivals(evidence, best, effect, effects) for effect in best.hypothesis.effects]
