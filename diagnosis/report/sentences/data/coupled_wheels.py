"""A sentence about the body by which the wheels of a drive accelerate each other."""

from collections.abc import Iterator

from diagnosis.inference.evidence.coupled_wheels import fitted_coupling
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.report.sentences.quantities import with_error

CLEAR = 3.0
"""Standard errors from which the coupling is stated."""


def coupling_sentences(fit: HypothesisFit) -> Iterator[str]:
    """Yield how strongly the wheels are coupled, if the data show it clearly."""
    coupling = fitted_coupling(fit)
    if coupling is not None and abs(coupling.share) >= CLEAR * coupling.std:
        size = with_error(100.0 * abs(coupling.share), 100.0 * coupling.std)
        verb = "takes" if coupling.share > 0.0 else "adds"
        yield (
            f"The body of the robot couples its wheels: an acceleration of one wheel also {verb} torque at the "
            f"other one, {size} % of what it takes at its own. nominal.yaml states no such number; it is fitted, "
            "and is no fault of the robot."
        )


def in_json(fit: HypothesisFit) -> dict[str, object]:
    """Return the coupling for answer.json; empty if it is known, or no voltage drives a wheel."""
    coupling = fitted_coupling(fit)
    return {} if coupling is None else {"wheel_coupling": {"share": coupling.share, "std": coupling.std}}
