"""The figures of merit of a diagnosis, by kind and overall, with their binomial intervals."""

from collections.abc import Callable, Iterable, Sequence
from math import sqrt
from statistics import median

from score import GAIN_ERROR, Score

Outcomes = Callable[[Score], Iterable[bool]]
LIMITS_S = {"motor_steady": 1.0, "motor_step": 5.0, "tof_bench": 1.0, "drive_log": 20.0}
"""CPU seconds per case; of a drive, per minute of log."""
SURE = 0.999


def _of(category: str, outcome: Callable[[Score], bool]) -> Outcomes:
    return lambda each: [outcome(each)] if each.category == category else []


def _gain(each: Score) -> list[bool]:
    if each.category == "outside" or (each.gain_error is None and not each.failed):
        return []
    return [each.gain_error is not None and each.gain_error <= GAIN_ERROR]


def _failed_or(outcome: Callable[[Score], bool]) -> Callable[[Score], bool]:
    return lambda each: bool(each.failed) or outcome(each)


def _wrong_though_sure(each: Score) -> list[bool]:
    names = zip(each.confidences, each.name_alike, strict=True)
    return [not is_alike for confidence, is_alike in names if confidence >= SURE]


FIGURES: tuple[tuple[str, str, Outcomes], ...] = (
    ("one: right name, or in a set of 3", ">= 97 %", _of("single", lambda each: bool(each.right))),
    ("one: top name exact", ">= 95 %", _of("single", lambda each: bool(each.exact))),
    ("one: and reported as unexplained", "", _of("single", lambda each: each.unexplained)),
    ("two: both right", ">= 88 %", _of("pair", lambda each: bool(each.right))),
    ("two: both exact", "", _of("pair", lambda each: bool(each.exact))),
    ("none: a name was reported", "<= 1 %", _of("none", _failed_or(lambda each: each.named))),
    ("none: reported as unexplained", "", _of("none", _failed_or(lambda each: each.unexplained))),
    (
        "outside: unexplained, and no name",
        ">= 93 %",
        _of("outside", lambda each: each.unexplained and not each.named),
    ),
    ("outside: reported as unexplained", "", _of("outside", lambda each: each.unexplained)),
    (
        "  of those: channel and covariate",
        "",
        lambda each: [bool(each.place)] if each.category == "outside" and each.unexplained else [],
    ),
    ("outside: a name was reported", "", _of("outside", _failed_or(lambda each: each.named))),
    ("parameters within 3 std errors", ">= 99 %", lambda each: each.within),
    ("parameters of large ones in 10 %", "", lambda each: each.close),
    ("gain within 0.05 of the true one", "", _gain),
    ("names over 99.9 % sure: wrong", "<= 0.5 %", _wrong_though_sure),
    ("names of the day's noise or drift", "", lambda each: [each.excused > 0]),
    ("cases that failed", "0", lambda each: [bool(each.failed)]),
)


def table(scores: Sequence[Score]) -> list[str]:
    """Return the lines of the table."""
    kinds = sorted({each.kind for each in scores})
    lines = [f"{'':34s} {'required':8s} {'all':24s} " + " ".join(f"{kind:14s}" for kind in kinds)]
    for name, required, outcomes in FIGURES:
        results = [list(outcomes(each)) for each in scores]
        cells = [_share([hit for each in results for hit in each], with_interval=True)]
        for kind in kinds:
            hits = [hit for each, result in zip(scores, results, strict=True) if each.kind == kind for hit in result]
            cells.append(_share(hits, with_interval=False))
        lines.append(f"{name:34s} {required:8s} {cells[0]:24s} " + " ".join(f"{cell:14s}" for cell in cells[1:]))
    for kind in kinds:
        seconds = [each.seconds / each.minutes for each in scores if each.kind == kind]
        per = " a minute of log" if kind == "drive_log" else ""
        lines.append(
            f"{kind}: CPU median {median(seconds):.2f} s, worst {max(seconds):.2f} s, "
            f"required {LIMITS_S[kind]:g} s{per}"
        )
    return lines


def by_day(scores: Sequence[Score]) -> list[str]:
    """Return lines to print: how often all is right in cases with and without each thing that spoils data."""
    names = sorted({name for each in scores for name in each.day})
    lines = [f"{'all is right':34s} {'with':24s} without"] if names else []
    for name in names:
        cells = [
            _share([not went_wrong(each) for each in scores if (name in each.day) is has], with_interval=True)
            for has in (True, False)
        ]
        lines.append(f"{name:34s} {cells[0]:24s} {cells[1]}")
    return lines


def went_wrong(result: Score) -> bool:
    """Return whether the answer is wrong in any respect."""
    if result.failed:
        return True
    if result.category == "outside":
        return result.named or not result.unexplained or not result.place
    return result.unexplained or result.right is False or (result.category == "none" and result.named)


def _share(hits: Sequence[bool], *, with_interval: bool) -> str:
    if not hits:
        return "-"
    text = f"{100.0 * sum(hits) / len(hits):.0f} % of {len(hits)}"
    if not with_interval:
        return text
    low, high = interval(sum(hits), len(hits))
    return f"{text} ({100.0 * low:.0f}-{100.0 * high:.0f})"


def interval(hits: int, cases: int) -> tuple[float, float]:
    """Return the 95 % interval of a share after Wilson (1927)."""
    z = 1.959964
    share, square = hits / cases, z**2 / cases
    middle = (share + 0.5 * square) / (1.0 + square)
    half = z * sqrt(share * (1.0 - share) / cases + 0.25 * square / cases) / (1.0 + square)
    return max(middle - half, 0.0), min(middle + half, 1.0)
