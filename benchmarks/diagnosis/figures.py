"""The figures of merit of a diagnosis, by kind and overall, with their binomial intervals."""

from collections.abc import Callable, Iterable, Sequence
from math import sqrt
from statistics import median

from score import GAIN_ERROR, Score

Outcomes = Callable[[Score], Iterable[bool]]
LIMITS_S = {"motor_steady": 2.0, "motor_step": 15.0, "tof_bench": 5.0, "drive_log": 60.0}


def _of(category: str, outcome: Callable[[Score], bool]) -> Outcomes:
    return lambda each: [outcome(each)] if each.category == category else []


def _gain(each: Score) -> list[bool]:
    if each.category == "outside" or (each.gain_error is None and not each.failed):
        return []
    return [each.gain_error is not None and each.gain_error <= GAIN_ERROR]


def _failed_or(outcome: Callable[[Score], bool]) -> Callable[[Score], bool]:
    return lambda each: bool(each.failed) or outcome(each)


FIGURES: tuple[tuple[str, str, Outcomes], ...] = (
    ("one: right name, or in a set of 3", ">= 95 %", _of("single", lambda each: bool(each.right))),
    ("one: top name exact", ">= 88 %", _of("single", lambda each: bool(each.exact))),
    ("one: and reported as unexplained", "", _of("single", lambda each: each.unexplained)),
    ("two: both right", ">= 80 %", _of("pair", lambda each: bool(each.right))),
    ("two: both exact", "", _of("pair", lambda each: bool(each.exact))),
    ("none: a name was reported", "<= 2 %", _of("none", _failed_or(lambda each: each.named))),
    ("none: reported as unexplained", "", _of("none", _failed_or(lambda each: each.unexplained))),
    ("outside: reported as unexplained", ">= 90 %", _of("outside", lambda each: each.unexplained)),
    (
        "  of those: channel and covariate",
        ">= 90 %",
        lambda each: [bool(each.place)] if each.category == "outside" and each.unexplained else [],
    ),
    ("outside: a name was reported", "<= 5 %", _of("outside", _failed_or(lambda each: each.named))),
    ("parameters within 3 std errors", ">= 95 %", lambda each: each.within),
    ("parameters of large ones in 10 %", ">= 90 %", lambda each: each.close),
    ("gain within 0.05 of the true one", "", _gain),
    ("cases that failed", "0", lambda each: [bool(each.failed)]),
)


def table(scores: Sequence[Score]) -> list[str]:
    """Lines to print."""
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
        seconds = [each.seconds for each in scores if each.kind == kind]
        lines.append(
            f"{kind}: median {median(seconds):.2f} s, worst {max(seconds):.2f} s, required {LIMITS_S[kind]:g} s"
        )
    return lines


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
