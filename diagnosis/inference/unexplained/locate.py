"""The channel in which an unexplained structure has its cause.

A misfit of one channel changes the parameters that it shares with other channels and causes structure in those too,
which is often clearer. The channel is the one without which the nominal model is adequate for all the others. If there
is none, or several, the cause shows in more than one channel, and the most significant structure comes first.
"""

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.fitting.hypothesis import Hypothesis
from diagnosis.inference.unexplained.adequacy import LEVEL, Adequacy, adequacy
from diagnosis.inference.unexplained.scatter import with_scatter


def located(evidence: Evidence, nominal: Hypothesis, result: Adequacy) -> Adequacy:
    """Return the structures, those of the channel with the cause first; `nominal` has no effects."""
    channels = dict.fromkeys(structure.channel for structure in result.structures if structure.p < LEVEL)
    if len(channels) < 2:
        return result
    causes = [channel for channel in channels if _is_adequate_without(evidence, nominal, channel)]
    if len(causes) != 1:
        return result
    (channel,) = causes
    return Adequacy(tuple(sorted(result.structures, key=lambda structure: structure.channel != channel)))


def _is_adequate_without(evidence: Evidence, nominal: Hypothesis, channel: str) -> bool:
    rows = evidence.fit.copy()
    for observed, place in zip(evidence.observed, evidence.places, strict=True):
        rows[place] &= observed.channel != channel
    others = evidence.with_rows(fit=rows)
    if not rows.any():
        return False
    (fit,) = fits(others, [(nominal, nominal.null())])
    return with_scatter(others, fit, adequacy(others, fit)).is_adequate
