"""Errors without a cause that are no rivals of an effect of the user's own, since they are the same error.

Errors of simple form and changes at one moment compete with the effects of the list, which can imitate what is in no
list. An effect of the user's own states such an error itself, for example as the law that a search discovered. So it
stays where a curve of nearly the same shape describes a few rows better.
"""

import numpy as np

from configs.effects.registry import EFFECTS
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.fitting.projection import orthonormal
from symolo.core.arrays import Array

SAME = 0.9
"""Share of the change by the effects, as a length, that an error can describe by another size, if it is the same."""


def is_error_of_own_effect(base: HypothesisFit, fit: HypothesisFit, columns: Array) -> bool:
    """Return whether an error is nearly the change that effects of the user's own make.

    Args:
        base: A fit without these effects.
        fit: The fit with them.
        columns: (N, k), changes of the residuals by the error, in sigmas.
    """
    effects = [effect for effect in fit.hypothesis.effects if effect not in base.hypothesis.effects]
    if not effects or any(effect.kind.name not in EFFECTS.files for effect in effects):
        return False
    root = fit.root_weights()
    change = root * (base.z - fit.z * fit.sd / base.sd)
    described = orthonormal(columns * root[:, None]).T @ change
    return bool(np.linalg.norm(described) >= SAME * np.linalg.norm(change))
