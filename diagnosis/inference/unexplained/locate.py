"""In which channel does it live, what no name accounts for?

A misfit of one channel pulls at the parameters that it shares with others and leaves structure in those too, often the
clearer one. The channel is the one without which the nominal model suits all the rest; where there is none such, or
several, the cause shows in more than one, and the most significant structure stands.
"""

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fit import fits
from diagnosis.inference.hypothesis import Hypothesis
from diagnosis.inference.unexplained.adequacy import LEVEL, Adequacy, adequacy
from diagnosis.inference.unexplained.scatter import with_scatter


def located(evidence: Evidence, nominal: Hypothesis, left: Adequacy) -> Adequacy:
    """What is left, the channel first in which it lives; `nominal` is without effects."""
    channels = dict.fromkeys(structure.channel for structure in left.structures if structure.p < LEVEL)
    if len(channels) < 2:
        return left
    alone = [channel for channel in channels if _suits_without(evidence, nominal, channel)]
    if len(alone) != 1:
        return left
    (channel,) = alone
    return Adequacy(tuple(sorted(left.structures, key=lambda structure: structure.channel != channel)))


def _suits_without(evidence: Evidence, nominal: Hypothesis, channel: str) -> bool:
    others = evidence.without(channel)
    if not others.fit.any():
        return False
    (fit,) = fits(others, [(nominal, nominal.null())])
    return with_scatter(others, fit, adequacy(others, fit)).is_adequate
