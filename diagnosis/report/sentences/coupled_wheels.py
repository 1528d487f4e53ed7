"""A sentence about the body by which the wheels of a drive accelerate each other."""

from collections.abc import Iterator

import numpy as np

from diagnosis.inference.evidence.coupled_wheels import NAME
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.report.sentences.quantities import with_error

CLEAR = 3.0
"""Standard errors from which the coupling is stated."""


def coupling_sentences(fit: HypothesisFit) -> Iterator[str]:
    """Yield how strongly the wheels are coupled, if the data show it clearly."""
    errors = np.sqrt(np.diag(fit.covariance)).tolist()
    for nuisance, x, error in zip(fit.hypothesis.nuisances, fit.x.tolist(), errors, strict=False):
        if nuisance.name == NAME and abs(x) >= CLEAR * error:
            size = with_error(100.0 * abs(x) * nuisance.tolerance, 100.0 * error * nuisance.tolerance)
            way = "takes" if x > 0.0 else "adds"
            yield (
                f"The body of the robot couples its wheels: an acceleration of one wheel also {way} torque at the "
                f"other one, {size} % of what it takes at its own. nominal.yaml states no such number; it is fitted, "
                "and is no fault of the robot."
            )
