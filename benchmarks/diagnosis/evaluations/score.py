"""The score of an answer of a diagnosis against the true world of a case."""

import itertools
import math
from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, replace

from hidden_cases import (
    Case,  # pyright: ignore[reportAttributeAccessIssue] - from a folder of tests
    Day,  # pyright: ignore[reportAttributeAccessIssue]
    Verdict,  # pyright: ignore[reportAttributeAccessIssue]
    judge,  # pyright: ignore[reportAttributeAccessIssue]
)

LARGEST_SET = 3
LARGE_DROP = 400.0
"""Ten times as much as a detectable effect takes: the size itself ought to be right within a tenth."""
GAIN_ERROR = 0.05
STD_ERRORS = 3.0


@dataclass(frozen=True)
class Score:
    """The score of one case; None where a question does not apply.

    Attributes:
        category: What was hidden.
        kind: Kind of data.
        truth: Names, with their discrete parameters.
        drops: Expected drop of the cost for each.
        nameless: What no single name can take of an outside effect.
        right: The names, each or a member of its set of at most three, and no other.
        exact: The names themselves, or names that these data cannot distinguish from them.
        named: Whether any name was reported.
        unexplained: Whether remaining structure was reported.
        place: Whether it was placed in the right channel and covariate.
        within: Whether each parameter of an effect that was named correctly is within three standard errors.
        close: Whether each parameter of a large effect is within a tenth.
        gain_error: Error of the held-out gain.
        confidences: Stated confidence of each reported name.
        name_hits: Whether each of them was hidden.
        name_alike: Whether it was, or these data cannot distinguish it from what was.
        excused: Reported names of what the day did to the data: neither right nor wrong, and counted nowhere else.
        seconds: CPU time of the diagnosis.
        minutes: Length of a drive; 1 for other kinds.
        failed: Text of an exception.
        day: What the logger and the day did to the data, in words.
        answer: The answer in short.
        sizes: Parameters of what was hidden.
    """

    category: str
    kind: str
    truth: tuple[str, ...] = ()
    drops: tuple[float, ...] = ()
    nameless: float = 0.0
    right: bool | None = None
    exact: bool | None = None
    named: bool = False
    unexplained: bool = False
    place: bool | None = None
    within: tuple[bool, ...] = ()
    close: tuple[bool, ...] = ()
    gain_error: float | None = None
    confidences: tuple[float, ...] = ()
    name_hits: tuple[bool, ...] = ()
    name_alike: tuple[bool, ...] = ()
    excused: int = 0
    seconds: float = 0.0
    minutes: float = 1.0
    failed: str = ""
    day: tuple[str, ...] = ()
    answer: str = ""
    sizes: tuple[str, ...] = ()


def score(
    case: Case,
    category: str,
    answer: Mapping | None,
    seconds: float = 0.0,
    failed: str = "",
    *,
    verdict: Verdict | None = None,
) -> Score:
    """Return the score of an answer, or of none where the diagnosis `failed`; the verdict is made if not given."""
    hidden = [*case.world.effects, *case.world.outsides]
    truth = tuple(each.variant if hasattr(each, "variant") else each.name for each in hidden)
    knowable = judge(case) if verdict is None else verdict
    drops = (*knowable.drops, *([knowable.beyond] if case.world.outsides else []))
    sizes = tuple(_short(each.parameters) for each in hidden)
    expects_names = category in {"single", "pair"}
    minutes = _minutes(case)
    known = Score(
        category,
        case.bench.kind,
        truth,
        drops,
        knowable.nameless,
        seconds=seconds,
        minutes=minutes,
        day=traits(case.day),
        sizes=sizes,
    )
    if answer is None:
        wrong = False if expects_names else None
        return replace(known, right=wrong, exact=wrong, failed=failed or "no answer")
    accepted = {name for name, same in zip(truth, knowable.equivalent, strict=False) for name in (name, *same)}
    excuses = set(knowable.excused) - accepted
    effects = [each for each in answer["effects"] if not _is_excused(each, excuses, case)]
    names = [variant(each) for each in effects]
    real = {each.variant for each in case.world.effects}
    sets = [{name, *each.get("ambiguous_with", ())} for name, each in zip(names, effects, strict=True)]
    within, close = _parameters(case, drops, effects)
    gain = answer.get("heldout_gain")
    return replace(
        known,
        right=_matches([{name} for name in truth], sets, LARGEST_SET) if expects_names else None,
        exact=_exact(truth, knowable.equivalent, names) if expects_names else None,
        named=bool(effects),
        unexplained=bool(answer["unexplained"]),
        place=_placed(case, answer),
        within=within,
        close=close,
        gain_error=abs(gain - knowable.gain) if gain is not None and category != "outside" else None,
        confidences=tuple(float(each.get("confidence", 0.0)) for each in effects),
        name_hits=tuple(name in real for name in names),
        name_alike=tuple(name in accepted for name in names),
        excused=len(answer["effects"]) - len(effects),
        answer=_summary(answer),
    )


def traits(day: Day) -> tuple[str, ...]:
    """Return what a day does that a diagnosis may stumble over."""
    odd = day.outliers
    share = max(odd.shares.values()) if odd else 0.0
    noise = max((abs(math.log(factor)) for factor in day.noise.values()), default=0.0)
    tolerance = max((abs(math.log(factor)) for factor in day.tolerance.values()), default=0.0)
    has = {
        "over 2 % outliers": share > 0.02,
        "outliers in runs": odd is not None and share > 0.005 and odd.in_runs > 0.2,
        "outliers of one sign": odd is not None and share > 0.005 and odd.sign != 0.0,
        "noise over 1.3 off": noise > math.log(1.3),
        "tolerance over 1.3 off": tolerance > math.log(1.3),
        "correlated": abs(day.correlation or 0.0) > 0.1,
        "heavy tails": math.isfinite(day.degrees),
        "drifting zero": bool(day.wander),
    }
    return tuple(name for name, is_there in has.items() if is_there)


def _minutes(case: Case) -> float:
    if case.bench.kind != "drive_log":
        return 1.0
    trials, time = case.columns["trial"], case.columns["t_s"]
    return sum(float(max(time[trials == trial])) for trial in set(trials.tolist())) / 60.0


def _is_excused(effect: Mapping, excuses: AbstractSet[str], case: Case) -> bool:
    """Return whether an effect describes an error of the stated noise or zero, for a scale with the right sign."""
    if effect["name"] not in excuses:
        return False
    factor, scale = case.day.noise.get("polynomial_mm", 1.0), effect["parameters"].get("scale")
    return scale is None or (float(scale) > 1.0) == (factor > 1.0)


def variant(effect: Mapping) -> str:
    """Return the name of an effect of an answer, with its discrete parameter."""
    words = [value for value in effect.get("parameters", {}).values() if isinstance(value, str)]
    return f"{effect['name']}[{words[0]}]" if words else effect["name"]


def _matches(truths: Sequence[set[str]], sets: Sequence[set[str]], largest: int) -> bool:
    """Return whether each truth can be paired with a set of its own that contains one of its names."""
    if len(truths) != len(sets) or any(len(each) > largest for each in sets):
        return False
    return any(all(a & b for a, b in zip(truths, order, strict=True)) for order in itertools.permutations(sets))


def _exact(truth: Sequence[str], equivalent: Sequence[Sequence[str]], names: Sequence[str]) -> bool:
    accepted = [{name, *same} for name, same in zip(truth, equivalent, strict=True)]
    return _matches(accepted, [{name} for name in names], 1)


def _placed(case: Case, answer: Mapping) -> bool | None:
    if not case.world.outsides or not answer["unexplained"]:
        return None
    where = answer.get("unexplained_where", {})
    return any(
        where.get("channel") in each.channels and where.get("covariate") in each.covariates
        for each in case.world.outsides
    )


def _parameters(
    case: Case, drops: Sequence[float], effects: Sequence[Mapping]
) -> tuple[tuple[bool, ...], tuple[bool, ...]]:
    within, close = [], []
    for true, drop in zip(case.world.effects, drops, strict=False):
        for each in effects:
            if variant(each) != true.variant:
                continue
            for name, value in true.parameters.items():
                if isinstance(value, str):
                    continue
                error = abs(float(each["parameters"][name]) - value)
                std = each.get("std", {}).get(name)
                if std is not None:
                    within.append(error <= STD_ERRORS * std)
                if drop > LARGE_DROP:
                    neutral = 1.0 if name in {"scale", "gain"} else 0.0
                    close.append(error <= 0.1 * abs(value - neutral))
    return tuple(within), tuple(close)


def _summary(answer: Mapping) -> str:
    parts = []
    for each in answer["effects"]:
        rivals = each.get("ambiguous_with", ())
        sure = f" {100.0 * each['confidence']:.4g}%" if "confidence" in each else ""
        parts.append(
            f"{variant(each)} {_short(each['parameters'])}{sure}" + (f" or {' or '.join(rivals)}" if rivals else "")
        )
    if answer["unexplained"]:
        where = answer.get("unexplained_where", {})
        parts.append(f"unexplained {where.get('channel')} by {where.get('covariate')}")
    return "; ".join(parts) or "nothing"


def _short(parameters: Mapping) -> str:
    return " ".join(f"{k}={v}" if isinstance(v, str) else f"{k}={float(v):.4g}" for k, v in parameters.items())
