"""Sentences about what differs from session to session and is no property of the robot."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from diagnosis.inference.evidence.sessions import FittedError, fitted_errors
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.report.sentences.quantities import with_error


@dataclass(frozen=True)
class _Words:
    """Words for the error of one effect."""

    subject: str
    positive: str
    """What a positive number means."""
    negative: str
    """What a negative number means."""
    unit: str
    """A thousandth of the effect's unit."""


WORDS: Mapping[str, _Words] = MappingProxyType(
    {
        "marker_yaw": _Words(
            "the tracked heading is", "ahead of that of the robot by", "behind that of the robot by", "mrad"
        ),
        "marker_offset": _Words("the tracked point is", "ahead of the axle by", "behind the axle by", "mm"),
        "pose_time_offset": _Words("the logged pose is", "older than its row by", "newer than its row by", "ms"),
        "pose_clock_drift": _Words("the logged pose gets", "older by", "newer by", "ms per s"),
    }
)


def session_sentences(fit: HypothesisFit) -> Iterator[str]:
    """Yield a sentence for each kind of error, with its size in every session that determines it."""
    by_effect: dict[str, list[FittedError]] = {}
    for error in fitted_errors(fit):
        if error.is_change:
            place = "ahead of" if error.value > 0.0 else "behind"
            size = with_error(1e3 * abs(error.value), 1e3 * error.std)
            yield (
                f"Since the pause before trial {error.session}, the tracked heading is {size} mrad {place} where it "
                "was before the first pause. This is fitted with the robot and is no part of it."
            )
        else:
            by_effect.setdefault(error.effect, []).append(error)
    for effect, errors in by_effect.items():
        words = WORDS[effect]
        positive, negative = [e for e in errors if e.value >= 0.0], [e for e in errors if e.value < 0.0]
        parts = [f"{words.positive} {_sizes(positive)} {words.unit}"] if positive else []
        parts += [f"{words.negative} {_sizes(negative)} {words.unit}"] if negative else []
        text = ", and ".join(parts)
        yield f"By session, {words.subject} {text}. This is fitted with the robot and is no part of it."


def _sizes(errors: Sequence[FittedError]) -> str:
    return ", ".join(f"{with_error(1e3 * abs(e.value), 1e3 * e.std)} ({e.session})" for e in errors)
