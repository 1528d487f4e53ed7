"""The kinds of measurement that can be compared with a simulation."""

from diagnosis.measured.measurement import CaseKind, Measurement
from symolo.core.errors import InputError

PREDICTED_KINDS = tuple(kind for kind in CaseKind if kind not in {CaseKind.TOGETHER, CaseKind.OTHER})
"""Kinds with stages in `diagnosis.predictors`, which take long to load."""


def check_kind(measurement: Measurement) -> None:
    """Raise InputError if no stage of the simulator predicts such data."""
    if measurement.kind not in PREDICTED_KINDS and not measurement.cases:
        allowed = ", ".join(PREDICTED_KINDS)
        what = f"data of kind {measurement.kind} cannot be compared with a simulation"
        cure = (
            "diagnose a bench or a drive; `symolo inspect` shows what these data contain, and `symolo case init` makes "
            "a case of a log"
        )
        raise InputError(what, where=measurement.where, allowed=allowed, cure=cure)
