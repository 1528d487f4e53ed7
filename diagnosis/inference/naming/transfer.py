"""Whether an effect transfers: is it the same in every manoeuvre, in every session and at every speed?

An effect with a cause acts everywhere. A law that only describes one manoeuvre makes the predictions of another one
worse. Each group of rows is left out in turn, and the models with and without the effect are fitted to the rest. The
fall of the cost by the effect is the logarithm of a likelihood ratio, so its difference with and without the group is
what the group says about the effect, given the rest (a partial Bayes factor: O'Hagan, J. Royal Statist. Soc. B 57
(1995) 99-138). If the group speaks clearly against the effect, the effect is no cause.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import Contest, HypothesisFit, fits, fits_of_contests
from diagnosis.inference.selection.refusal import is_of_noise
from diagnosis.measured.channel import Mask

MAX_SESSIONS = 3
"""Largest number of groups of successive trials."""
MIN_SAMPLES = 10
"""Smallest number of samples of the fit in a group, and in the rest."""
OUTER = 1.0 / 3.0
"""Share of the samples that count as slow or near, and as fast or far."""
MAIN_COVARIATES = ("omega_rad_s", "dtheta", "distance_m")
"""Covariates that tell manoeuvres apart."""
AGAINST = 10.0
"""Rise of the cost from which a group contradicts an effect. Of 373 right names in cases of the family `wide_a`, none
was contradicted by more than 8.7 beyond AGAINST_SHARE."""
AGAINST_SHARE = 0.05
"""Share of the fall of the cost by an effect, which a contradiction must reach too. It is an empirical
number, set on the family `wide_a`, and follows from no theory. It is generous to strong effects: beside a fall of 4000,
a group that contradicts the effect by less than 200 is let pass."""


@dataclass(frozen=True)
class Group:
    """Samples that are left out together."""

    name: str
    rows: Mask
    """(N,), samples of the fit."""


@dataclass(frozen=True)
class Support:
    """What one group of samples says about an effect."""

    group: str
    fall: float
    """Fall of the cost by the effect over all samples, minus that without the group; below zero, the group speaks
    against the effect."""


def groups(evidence: Evidence, trial_names: Sequence[str]) -> tuple[Group, ...]:
    """Return the manoeuvres, the sessions and the outer ranges of speed or distance.

    Args:
        evidence: The observations.
        trial_names: Names of the trials.
    """
    groups = [*trial_groups(evidence, trial_names, evidence.fit), *_covariate_range_groups(evidence)]
    fitted = int(np.count_nonzero(evidence.fit))
    return tuple(group for group in groups if MIN_SAMPLES <= np.count_nonzero(group.rows) <= fitted - MIN_SAMPLES)


def supports(
    evidence: Evidence, fit: HypothesisFit, bases: Sequence[HypothesisFit], parts: Sequence[Group]
) -> tuple[tuple[Support, ...], ...]:
    """Return what each group says about each effect of a fit.

    Args:
        evidence: The observations.
        fit: The fit with all effects.
        bases: The fits without one of the effects, in the order of the effects of `fit`.
        parts: The groups.

    Returns:
        For each effect a tuple with one entry for each group.
    """
    # All have the noise of the model with all effects. A worse model would have more outliers or a higher level, for
    # which outliers anywhere cost less: rows that do not show the effect would seem to speak against it.
    noises = [base.noise if _is_noisier(base, fit) else fit.noise for base in bases]
    alike = fits(evidence, [(base.hypothesis, base.x) for base in bases], noises=noises)
    starts, known = [(each.hypothesis, each.x) for each in (fit, *alike)], [fit.noise, *noises]
    rests = [evidence.with_rows(fit=evidence.fit & ~part.rows) for part in parts]
    rest_fits = fits_of_contests([Contest(rest, starts, noises=known) for rest in rests])
    rows = [
        [
            Support(part.name, (base.cost - fit.cost) - (fewer.cost - model.cost))
            for base, fewer in zip(alike, without, strict=True)
        ]
        for part, (model, *without) in zip(parts, rest_fits, strict=True)
    ]
    return tuple(zip(*rows, strict=True)) if rows else tuple(() for _ in bases)


def _is_noisier(base: HypothesisFit, fit: HypothesisFit) -> bool:
    """Return whether an effect of the noise makes the difference, so that the level of the noise has its place."""
    return any(is_of_noise(fit, effect) for effect in fit.hypothesis.effects if effect not in base.hypothesis.effects)


def contradiction(by_group: Sequence[Support], drop: float) -> str:
    """Return which group contradicts an effect and which one shows it; empty if none contradicts it.

    Args:
        by_group: What each group says about the effect.
        drop: Fall of the cost by the effect over all samples.
    """
    weakest = min(by_group, key=lambda support: support.fall, default=None)
    if weakest is None or weakest.fall > -max(AGAINST, AGAINST_SHARE * drop):
        return ""
    strongest = max(by_group, key=lambda support: support.fall)
    return f"{weakest.group} (it describes {strongest.group})"


def trial_groups(evidence: Evidence, trial_names: Sequence[str], rows: Mask) -> tuple[Group, ...]:
    """Return the manoeuvres if the names of the trials tell them, or else up to MAX_SESSIONS groups of successive ones.

    Args:
        evidence: The observations.
        trial_names: Names of the trials; those of one manoeuvre are equal up to the last slash.
        rows: (N,), samples to group.
    """
    manoeuvres = np.array([name.rpartition("/")[0] for name in trial_names])
    names = np.unique(manoeuvres[np.unique(evidence.trial[rows])]).tolist()
    if len(names) > 1:
        return tuple(Group(f"{name}/*", rows & (manoeuvres == name)[evidence.trial]) for name in names)
    trials = np.unique(evidence.trial[rows])
    if len(trials) < 2:
        return ()
    parts = np.array_split(trials, min(MAX_SESSIONS, len(trials)))
    return tuple(Group(_trials_text(part), rows & np.isin(evidence.trial, part)) for part in parts)


def _trials_text(numbers: NDArray[np.int64]) -> str:
    first, last = int(numbers[0]) + 1, int(numbers[-1]) + 1
    return f"trial {first}" if first == last else f"trials {first} to {last}"


def _covariate_range_groups(evidence: Evidence) -> Iterator[Group]:
    """Yield the samples with the smallest and with the largest sizes of each main covariate."""
    for name in MAIN_COVARIATES:
        size = np.full(len(evidence.values), np.nan)
        for observed, place in zip(evidence.observed, evidence.places, strict=True):
            for covariate in observed.covariates:
                if covariate.name == name:
                    size[place] = np.abs(covariate.values)
        known = evidence.fit & np.isfinite(size)
        if not known.any():
            continue
        low, high = np.quantile(size[known], [OUTER, 1.0 - OUTER]).tolist()
        if low < high:
            yield Group(f"{name} below {low:.3g}", known & (size < low))
            yield Group(f"{name} above {high:.3g}", known & (size > high))
