"""Sentences about what differs from session to session and is no property of the robot."""

from collections.abc import Iterator, Mapping
from types import MappingProxyType

from diagnosis.inference.evidence.sessions import FittedError, fitted_errors
from diagnosis.inference.fit import HypothesisFit
from diagnosis.report.sentences.quantities import with_error

WORDS: Mapping[str, tuple[str, float, str]] = MappingProxyType(
    {
        "marker_yaw": ("the tracked heading is ahead of that of the robot by", 1e3, "mrad"),
        "marker_offset": ("the tracked point is ahead of the axle by", 1e3, "mm"),
        "pose_time_offset": ("the logged pose is older than its row by", 1e3, "ms"),
        "pose_clock_drift": ("the logged pose ages by", 1e3, "ms per s"),
    }
)
"""Words, factor and unit for the error of each effect."""


def session_sentences(fit: HypothesisFit) -> Iterator[str]:
    """Yield a sentence for each kind of error, with its size in every session that determines it."""
    by_effect: dict[str, list[FittedError]] = {}
    for error in fitted_errors(fit):
        by_effect.setdefault(error.effect, []).append(error)
    for effect, errors in by_effect.items():
        words, factor, unit = WORDS[effect]
        sizes = ", ".join(f"{with_error(factor * e.value, factor * e.std)} ({e.session})" for e in errors)
        yield f"By session, {words} {sizes} {unit}. This is fitted with the robot and is no part of it."
