"""The selection of effects together with the noise that they leave, and with voltages that act early."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from diagnosis.inference.evidence.early_voltages import early_fit, with_updated_share
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.evidence.noise_level import with_clear_correlations, with_estimated_noises
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.fitting.hypothesis import CandidateEffect, Hypothesis
from diagnosis.inference.selection.stepwise import Selection, select

MAX_WEIGHT_RATIO = 1.25
"""Ratio of the new to the old weight of a row, from which the effects are selected again."""


def selected(evidence: Evidence, bare: Hypothesis, effects: Sequence[CandidateEffect]) -> tuple[Evidence, Selection]:
    """Return the evidence with the noise that the selected effects leave, and the selection.

    Args:
        evidence: The observations.
        bare: The hypothesis without effects.
        effects: The effects that may be selected.
    """
    selection = select(evidence, bare, effects)
    # Residuals without the effects were correlated for longer than the noise, so that rows had too little weight.
    updated = with_updated_share(with_estimated_noises(evidence, selection.fit), selection.fit)
    correlated = with_clear_correlations(updated, selection.fit)
    if correlated is not updated:
        return correlated, select(correlated, bare, effects)
    if np.any(updated.weight * evidence.sd**2 > MAX_WEIGHT_RATIO * evidence.weight * updated.sd**2):
        return updated, select(updated, bare, effects, selection)
    return evidence, selection


def selected_with_early_voltages(
    evidence: Evidence, bare: Hypothesis, effects: Sequence[CandidateEffect]
) -> tuple[Evidence, Hypothesis, Selection]:
    """Return evidence, bare hypothesis and selection, with voltages that act early if the data need them.

    An effect may look like such voltages, and such voltages like an effect. So the test is repeated after the
    selection: voltages that were accepted before it must still be needed beside the selected effects, and voltages that
    were rejected may be needed then.

    Args:
        evidence: The observations.
        bare: The hypothesis without effects.
        effects: The effects that may be selected.
    """
    (bare_fit,) = fits(evidence, [(bare, bare.null())])
    early = early_fit(evidence, bare_fit)
    if early is None or not early.is_needed:
        evidence, selection = selected(evidence, bare, effects)
        early = None if early is None else early_fit(evidence, selection.fit)
        if early is None or not early.is_needed:
            return evidence, bare, selection
        bare = replace(early.hypothesis, effects=())
        evidence, selection = selected(early.evidence, bare, effects)
        return evidence, bare, selection
    with_early = replace(early.hypothesis, effects=())
    early_evidence, selection = selected(early.evidence, with_early, effects)
    # The same effects without the nuisances of early voltages, which follow those of `bare`.
    fewer = replace(selection.fit.hypothesis, nuisances=bare.nuisances)
    x = np.delete(selection.fit.x, range(len(bare.nuisances), len(with_early.nuisances)))
    (fit_without_early,) = fits(evidence, [(fewer, x)])
    early_beside_effects = early_fit(evidence, fit_without_early)
    if early_beside_effects is not None and early_beside_effects.is_needed:
        return early_evidence, with_early, selection
    evidence, selection = selected(evidence, bare, effects)
    return evidence, bare, selection
