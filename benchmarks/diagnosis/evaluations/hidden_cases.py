"""The cases: a mix of one effect, two, none and one outside the tables, over all names, kinds and sizes."""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

# The root comes first: folders of tests have the names of our packages, and would hide them.
sys.path.insert(0, str(Path(__file__).parents[3] / "tests"))
sys.path.insert(0, str(Path(__file__).parents[3]))

from gap_cases import (  # pyright: ignore[reportMissingImports] - by the path above
    DETECTABLE,
    FAMILIES,
    KINDS,
    NAMELESS,
    Case,
    Day,
    Verdict,
    draw_bench,
    judge,
    make_case,
    names,
    outside_names,
    write,
)

__all__ = ["FAMILIES", "KINDS", "Case", "Day", "Judged", "Plan", "Verdict", "hidden_case", "judge", "plans", "write"]

PATTERN = ("single", "pair", "single", "outside", "single", "pair", "none", "single", "outside", "single")
PATTERN += ("pair", "single", "none", "outside", "pair", "single", "none", "single", "pair", "outside")
"""Of twenty: eight, five, three and four."""
TRIES = 12
"""Sizes that are drawn until one is detectable; after half of them, of another name."""


@dataclass(frozen=True)
class Plan:
    """One case to make; the same plan is the same case."""

    number: int
    category: str
    kind: str
    turn: int
    """Number among the cases of its category and kind; names are taken in turn."""
    seed: int
    family: str = "narrow"

    @property
    def name(self) -> str:
        return f"{self.number:04d}_{self.category}_{self.kind}"


def plans(cases: int, seed: int, kinds: Sequence[str], family: str = "narrow") -> list[Plan]:
    """Return the first plans of an endless series."""
    turns: dict[str, int] = {}
    series = []
    for number in range(cases):
        category = PATTERN[number % len(PATTERN)]
        count = turns.setdefault(category, 0)
        turns[category] = count + 1
        series.append(Plan(number, category, kinds[count % len(kinds)], count // len(kinds), seed, family))
    return series


@dataclass(frozen=True)
class Judged:
    """What was found out about a case when it was made, so that another run need not find it out again.

    Attributes:
        plan: The plan, as a text that differs between any two plans.
        attempt: Number of the draw that is detectable.
        verdict: What can be known from the case.
    """

    plan: str
    attempt: int
    verdict: Verdict


def hidden_case(plan: Plan) -> Case:
    """Return the case of a plan, whose effects are detectable unless none of the drawn sizes is."""
    return _detectable(plan)[0]


def judged_case(plan: Plan, known: Mapping[str, Judged]) -> tuple[Case, Judged]:
    """Return the case of a plan and what can be known from it, which may be known already."""
    key = repr(plan)
    if key in known:
        return _drawn(plan, known[key].attempt), known[key]
    case, attempt = _detectable(plan)
    return case, Judged(key, attempt, judge(case))


def _detectable(plan: Plan) -> tuple[Case, int]:
    """Return the first draw of a plan that shows what it hides, or the last draw, and the number of the draw."""
    attempt, case = 0, _drawn(plan, 0)
    while attempt + 1 < TRIES and not _shows(case):
        attempt += 1
        case = _drawn(plan, attempt)
    return case, attempt


def _shows(case: Case) -> bool:
    verdict = judge(case, with_rivals=bool(case.world.outsides))
    named = all(drop > DETECTABLE for drop in verdict.drops)
    return named and (not case.world.outsides or verdict.nameless > NAMELESS)


def _drawn(plan: Plan, attempt: int) -> Case:
    family = FAMILIES[plan.family]
    rows = family.rows(plan.kind, float(np.random.default_rng([plan.seed, plan.number]).random()))
    rng = np.random.default_rng([plan.seed, plan.number, attempt])
    seed = int(rng.integers(2**31))
    bench = draw_bench(plan.kind, seed, rows, plan.family)
    library, strange = names(bench), outside_names(plan.kind, plan.family)
    turn = plan.turn if 2 * attempt < TRIES else int(rng.integers(1000))
    match plan.category:
        case "none":
            return make_case(plan.kind, seed, rows=rows, family=plan.family)
        case "outside":
            chosen = [strange[turn % len(strange)]]
            if family.two_outside and rng.random() < family.two_outside:
                chosen.append(str(rng.choice([name for name in strange if name not in chosen])))
            return make_case(plan.kind, seed, outside=chosen, rows=rows, family=plan.family)
        case "single":
            return make_case(plan.kind, seed, [(library[turn % len(library)], None)], rows=rows, family=plan.family)
        case _:
            pair = rng.choice(library, 2, replace=False).tolist()
            return make_case(plan.kind, seed, [(name, None) for name in pair], rows=rows, family=plan.family)
