"""The whole diagnosis of one measurement: named effects, their confidence, what stays unexplained, and the gain."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from math import isfinite

from configs.schema.robot import RobotConfig
from diagnosis.case_robot import base_robot_of, checked_against, nominal_of
from diagnosis.discovery.law import DiscoveredLaw, Discovery
from diagnosis.inference.evidence.coupled_wheels import wheel_coupling
from diagnosis.inference.evidence.early_voltages import EarlyPart, early_part
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.evidence.rounding import with_shared_rounding
from diagnosis.inference.evidence.whole_runs import with_whole_runs
from diagnosis.inference.fitting.fit import HypothesisFit, fits
from diagnosis.inference.fitting.hypothesis import CandidateEffect, Hypothesis, moved
from diagnosis.inference.gain import Gain, gain
from diagnosis.inference.naming.named_effect import NamedEffect
from diagnosis.inference.naming.named_model import NamedModel, standing
from diagnosis.inference.naming.other_size import other_size
from diagnosis.inference.naming.transfer import groups
from diagnosis.inference.naming.verdict import CaseVerdict, WithheldName, conclusion
from diagnosis.inference.selection.candidates import Candidates, candidates
from diagnosis.inference.selection.refusal import is_of_noise
from diagnosis.inference.selection.rescue import rescued
from diagnosis.inference.selection.rivals import AS_GOOD, RivalComparison, compare_rivals
from diagnosis.inference.selection.selected import selected, selected_with_early_voltages
from diagnosis.inference.selection.stepwise import Selection
from diagnosis.inference.unexplained.adequacy import Adequacy, Structure, adequacy
from diagnosis.inference.unexplained.change import change_in_time
from diagnosis.inference.unexplained.drift.random_drift import RandomDrift, random_drift
from diagnosis.inference.unexplained.locate import located
from diagnosis.inference.unexplained.retained_effects import retained_effects
from diagnosis.inference.unexplained.scatter import with_scatter
from diagnosis.inference.unexplained.unlisted import with_forms
from diagnosis.measured.measurement import Measurement
from diagnosis.measured.predicted_kinds import check_kind
from diagnosis.observations import observations, with_sessions
from diagnosis.progress import DiagnosisProgress, Phase, unreported

MIN_BETTER = 0.5
"""Fall of the cost by which a rival must explain more to replace an effect."""
IN_ANSWER = {"distance_step_m": "previous_distance_m"}
"""Names of covariates in GAP_FORMAT, where they differ."""


@dataclass(frozen=True)
class Alternative:
    """A fit that explains the data as well as the named effects."""

    fit: HypothesisFit
    worse: float
    """Increase of the cost over the named effects, with a penalty for each parameter."""


@dataclass(frozen=True)
class Diagnosis:
    """Result of a diagnosis."""

    measurement: Measurement
    evidence: Evidence
    """The observations, to which the effects are fitted; without the `random_drift` if there is one."""
    measured: Evidence
    """The observations as they were measured, with all errors. Every gain is computed on them."""
    base_robot: RobotConfig
    """The robot that the nominal parameters of the measurement were put into."""
    nominal: RobotConfig
    candidates: Candidates
    selection: Selection
    fit: HypothesisFit
    """The fit with the named effects."""
    named: tuple[NamedEffect, ...]
    withheld: tuple[WithheldName, ...]
    """Names that were selected, but do not stand by themselves."""
    withdrawn: tuple[str, ...]
    """Names of effects that were selected and then withdrawn, since structure remains that they do not explain."""
    adequacy: Adequacy
    """Test of the selected model, before anything was withdrawn, or of the model without the names withheld."""
    gain: Gain | None
    """Gain of the extended model over the nominal one."""
    calibrated: Gain | None
    """Gain of plain calibration: the nominal model with its nuisances fitted and without effects."""
    random_drift: RandomDrift | None = None
    """The slow error of a range sensor, which is random and therefore not part of the fit."""
    alternatives: tuple[Alternative, ...] = ()
    """Fits with a rival in place of one named effect, which these data do not distinguish from `fit`."""
    discovery: Discovery | None = None
    """The search for a law where something stays unexplained; None if there was none. Its law is part of `fit`."""

    @property
    def law(self) -> DiscoveredLaw | None:
        """The law that describes what is unexplained; None if there is none."""
        return self.discovery.law if self.discovery else None

    @property
    def fitted_effects(self) -> tuple[NamedEffect | DiscoveredLaw, ...]:
        """The named effects, and the law if there is one: all by which the extended robot differs in kind."""
        return (*self.named, *((self.law,) if self.law else ()))

    @property
    def unexplained(self) -> Structure | None:
        """The structure that no effect explains; None if there is none."""
        return None if self.adequacy.is_adequate else self.adequacy.worst

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects with their choices."""
        return (
            *(named.effect.name for named in self.named),
            *((self.random_drift.effect.name,) if self.random_drift else ()),
        )

    @property
    def conclusion(self) -> CaseVerdict:
        structures = self.adequacy.structures
        return conclusion(
            self.names,
            self.withheld,
            is_adequate=self.adequacy.is_adequate,
            chance=structures[0].p if structures else 1.0,
            nearly=max((entry.drop for entry in self.selection.refused), default=0.0),
            scatter=max((level for _, level in self.scatters), default=1.0),
        )

    @property
    def scatters(self) -> tuple[tuple[str, float], ...]:
        """Scatter of good readings relative to the stated noise, by quantity with a stated noise, without any law."""
        # A law that takes some of the scatter leaves the conclusion as it is.
        fit = self.law.without if self.law else self.fit
        levels = zip(self.evidence.observed, fit.noise.levels.tolist(), strict=True)
        return tuple((observed.name, level) for observed, level in levels if observed.noise_is_stated)

    @property
    def early_voltages(self) -> EarlyPart | None:
        """The part of the voltages that acts before it is logged; None if they act as they are logged."""
        return early_part(self.evidence, self.fit)

    @property
    def extended(self) -> RobotConfig:
        """The robot with fitted nuisances and the named effects."""
        return self.fit.robot.with_effect(self.random_drift.effect) if self.random_drift else self.fit.robot

    def answer(self) -> dict[str, object]:
        """Return the answer in GAP_FORMAT, ready for JSON."""
        result: dict[str, object] = {
            "effects": [
                {
                    "name": named.name,
                    "parameters": named.parameters,
                    "std": {name: std for name, std in named.std.items() if isfinite(std)},
                    "confidence": round(named.comparison.confidence, 4),
                    "ambiguous_with": list(named.comparison.ambiguous_with),
                    "range": {seen.covariate: [seen.low, seen.high] for seen in named.ranges},
                }
                for named in self.named
            ]
            + ([self.random_drift.answer()] if self.random_drift else []),
            "unexplained": self.unexplained is not None,
        }
        if self.unexplained is not None:
            result["unexplained_where"] = {
                "channel": self.unexplained.channel,
                "covariate": IN_ANSWER.get(self.unexplained.covariate, self.unexplained.covariate),
            }
        if self.gain is not None:
            result["heldout_gain"] = self.gain.value
            result["heldout_gain_ci"] = [self.gain.low, self.gain.high]
        return result


def diagnose(
    measurement: Measurement, nominal: RobotConfig | None = None, progress: DiagnosisProgress | None = None
) -> Diagnosis:
    """Diagnose what the simulation gets wrong about a measurement.

    Args:
        measurement: A measurement of a kind that a stage predicts, or several of one robot as one
            (`diagnosis.together`).
        nominal: The nominal robot, in everything that the nominal parameters of the measurement do not define; the
            shipped robot `nominal` by default.
        progress: Receives how far the diagnosis is, also while its result is used; by default nobody does.

    Raises:
        InputError: No stage of the simulator predicts such data, or none of the data can be used.
    """
    check_kind(measurement)
    progress = progress or unreported()
    base_robot = base_robot_of(measurement, nominal)
    robot = nominal_of(measurement, base_robot)
    measurement = checked_against(measurement, robot)
    evidence, bare, library = _prepared(measurement, robot, progress)
    evidence, bare, selection = selected_with_early_voltages(evidence, bare, library.testable)
    progress.begin(Phase.STRUCTURE)
    selection, result = _with_structures(evidence, selection, library)
    measured = evidence
    evidence, selection, result, drift = _beside_random_drift(evidence, bare, library, selection, result)
    fit = selection.fit if result.is_adequate else _without_stand_ins(evidence, selection, result)
    progress.begin(Phase.RIVALS)
    model = _with_rivals(evidence, selection, fit, result, library)
    progress.begin(Phase.TRANSFER)
    parts = groups(evidence, [trial.name for trial in measurement.trials])
    model, withheld_names = standing(evidence, selection, model, library.testable, parts, measured=measured)
    other_sizes = [other_size(evidence, model.fit, each.effect, library.testable) for each in model.comparisons]
    fit = with_shared_rounding(evidence, with_whole_runs(measurement, evidence, model.fit))
    alternatives = tuple(_alternatives(measurement, evidence, model.comparisons))
    progress.begin(Phase.INTERVALS)
    # The memoized fits with their slopes need much memory and are not used again.
    evidence.memo.clear()
    measured.memo.clear()
    return Diagnosis(
        measurement=measurement,
        evidence=evidence,
        measured=measured,
        base_robot=base_robot,
        nominal=robot,
        candidates=library,
        selection=selection,
        fit=fit,
        named=tuple(
            NamedEffect.from_comparison(evidence, selection.nominal, fit, each, other)
            for each, other in zip(model.comparisons, other_sizes, strict=True)
        ),
        withheld=withheld_names,
        withdrawn=_withdrawn(selection, model, withheld_names),
        adequacy=model.result,
        gain=gain(measured, robot, fit.robot, (0.0, fit.local_change)),
        calibrated=gain(measured, robot, selection.nominal.robot, (0.0, selection.nominal.local_change)),
        random_drift=drift,
        alternatives=alternatives,
    )


def _prepared(
    measurement: Measurement, robot: RobotConfig, progress: DiagnosisProgress
) -> tuple[Evidence, Hypothesis, Candidates]:
    """Return the observations, the hypothesis without effects, and the effects that the data can show."""
    evidence, bare = observations(measurement, robot, progress)
    bare = replace(bare, nuisances=(*bare.nuisances, *wheel_coupling(evidence, robot)))
    bare, session_effects = with_sessions(measurement, evidence, bare)
    library = candidates(measurement, evidence, bare)
    testable = tuple(effect for effect in library.testable if effect.kind not in session_effects)
    return evidence, bare, replace(library, testable=testable)


def _with_structures(evidence: Evidence, selection: Selection, library: Candidates) -> tuple[Selection, Adequacy]:
    """Return the selection, or a better one that a structure of its residuals suggests, and what it leaves."""
    result = adequacy(evidence, selection.fit)
    # Outliers in successive rows favour no effect.
    if not result.leaves_only_outliers and (better := rescued(evidence, selection, library.testable)) is not None:
        selection, result = better, adequacy(evidence, better.fit)
    return selection, _structures_of(evidence, selection, result)


def _beside_random_drift(
    evidence: Evidence, bare: Hypothesis, library: Candidates, selection: Selection, result: Adequacy
) -> tuple[Evidence, Selection, Adequacy, RandomDrift | None]:
    """Return evidence, selection and structures beside a random drift of the ranges, and the drift if there is one."""
    drift = random_drift(evidence, selection.nominal, selection.fit)
    if drift is None:
        return evidence, selection, result, None
    without_drift = evidence.without(drift.path_m) if drift.memory is None else evidence.beside(drift.memory)
    without_drift, selection_beside = selected(without_drift, bare, library.testable)
    structures = _structures_of(without_drift, selection_beside, adequacy(without_drift, selection_beside.fit))
    # If the drift leaves a structure, it may itself be a part of the unknown cause. The likelihood of a bench is that
    # of the whole process, so that a drift leaves nothing over time there.
    if structures.has_cause or (drift.memory is not None and structures.changes_over_time):
        return evidence, selection, result, None
    return without_drift, selection_beside, structures, drift


def _with_rivals(
    evidence: Evidence, selection: Selection, fit: HypothesisFit, result: Adequacy, library: Candidates
) -> NamedModel:
    """Return a fit with the rivals of each of its effects; a rival that explains more replaces its effect."""
    effects, pairs = library.testable, selection.pairs
    comparisons = [
        compare_rivals(evidence, fit, effect, effects, pairs=pairs, is_whole=not result.has_cause)
        for effect in fit.hypothesis.effects
    ]
    # Beside an unexplained structure a rival may win by taking over a part of it, so names are compared only without.
    if result.leaves_only_outliers:
        fit, comparisons = _best_named(evidence, fit, comparisons, effects, pairs)
    return NamedModel(fit, comparisons, result)


def _withdrawn(selection: Selection, model: NamedModel, withheld: Sequence[WithheldName]) -> tuple[str, ...]:
    """Return the names that were selected and are neither named nor withheld, because structure remains."""
    if model.result.is_adequate:
        return ()
    remaining = {effect.name for effect in model.fit.hypothesis.effects} | {each.name for each in withheld}
    return tuple(name for name in selection.names if name not in remaining)


def _alternatives(
    measurement: Measurement, evidence: Evidence, comparisons: Sequence[RivalComparison]
) -> Iterator[Alternative]:
    """Yield the fits with a rival that explains the data as well as the effect in whose place it is."""
    for comparison in comparisons:
        for rival in comparison.rivals:
            if rival.worse < AS_GOOD:
                fit = with_shared_rounding(evidence, with_whole_runs(measurement, evidence, rival.fit))
                yield Alternative(fit, rival.worse)


def _structures_of(evidence: Evidence, selection: Selection, result: Adequacy) -> Adequacy:
    """Return all structure that the selected model leaves, with scatter and a jump in time, and find its channel."""
    result = with_scatter(evidence, selection.fit, result)
    jump = change_in_time(evidence, selection.nominal, selection.fit)
    if jump is not None:
        return Adequacy((jump, *result.structures))
    result = with_forms(evidence, selection.nominal, selection.fit, result)
    return result if result.is_adequate else located(evidence, selection.nominal.hypothesis, result)


def _without_stand_ins(evidence: Evidence, selection: Selection, result: Adequacy) -> HypothesisFit:
    """Return the fit with only those effects that are needed in addition to what is unexplained.

    Effects of the noise are removed first: wider noise can replace any structure of the mean and hides its size.
    """
    fit = selection.fit
    noise_effects = [effect for effect in fit.hypothesis.effects if is_of_noise(fit, effect)]
    if not result.has_cause:
        # A drift adds little to the noise, and outliers have a density of their own: neither stands behind an effect of
        # the noise.
        return _with_only(
            evidence, selection, fit, [*noise_effects, *retained_effects(evidence, selection.nominal, fit, result)]
        )
    mean_effects = [effect for effect in fit.hypothesis.effects if effect not in noise_effects]
    if len(mean_effects) < len(fit.hypothesis.effects):
        fit = _with_only(evidence, selection, fit, mean_effects)
        result = _structures_of(evidence, replace(selection, fit=fit), adequacy(evidence, fit))
    return _with_only(evidence, selection, fit, retained_effects(evidence, selection.nominal, fit, result))


def _with_only(
    evidence: Evidence, selection: Selection, fit: HypothesisFit, keep: Collection[CandidateEffect]
) -> HypothesisFit:
    """Return the fit with some of its effects."""
    effects = tuple(effect for effect in fit.hypothesis.effects if effect in keep)
    if len(effects) == len(fit.hypothesis.effects):
        return fit
    if not effects:
        return selection.nominal
    fewer = replace(fit.hypothesis, effects=effects)
    (refit,) = fits(evidence, [(fewer, moved(fit.x, fit.hypothesis, fewer))])
    return refit


def _best_named(
    evidence: Evidence,
    fit: HypothesisFit,
    comparisons: Sequence[RivalComparison],
    effects: Sequence[CandidateEffect],
    pairs: Sequence[HypothesisFit],
) -> tuple[HypothesisFit, Sequence[RivalComparison]]:
    """Replace a named effect by a rival that explains more, if there is one."""
    closest = [next((rival for rival in c.rivals if not rival.refused), None) for c in comparisons]
    better = [rival for rival in closest if rival is not None and rival.worse < -MIN_BETTER]
    if not better:
        return fit, comparisons
    best = min(better, key=lambda rival: rival.worse).fit
    return best, [compare_rivals(evidence, best, effect, effects, pairs=pairs) for effect in best.hypothesis.effects]
