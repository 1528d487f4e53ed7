"""Grades of answers against truth.json: counts with 95 % Wilson intervals, per kind and in all, and the wrong cases.

An effect counts as named where its name is an answer's name, or one of at most three that the answer leaves open. A
discrete parameter (side, sensor, material) must agree where the answer has one; `name[left]` is understood. The axis of
tilt_asymmetry is not in the data and not judged. Inductance and switching frequency of bridge_coast act as their
product, whose logarithm is judged with the relative standard errors added in squares. A name that the truth lists under
`equal` explains the data as well as the true one and counts as right; its parameters are not judged.
"""

import json
import math
import re
from pathlib import Path
from typing import Any

from benchmarks.diagnosis.independent_cases.recipes import Parameters

Truth = dict[str, Any]
Answer = dict[str, Any]
Named = dict[str, Any]
Marks = dict[str, tuple[int, int]]  # hits, and how many were judged

DISCRETE = ("side", "sensor", "material")
PERIODIC = ("phase_rad", "direction_rad")
PRODUCTS = {"bridge_coast": ("inductance_H", "switching_Hz")}
LEVELS = (0.95, 0.99, 0.999)
MISSING = "answers missing"
WITHIN = "parameters within three standard errors"
ROWS = [
    "one effect right",
    "one: first name exactly right",
    "one: first name right or a near rival of the truth",
    "one: further names reported",
    "both of two",
    "two: a third name reported",
    "two: at least one",
    "none: a name reported",
    "none: unexplained",
    "outside: unexplained and no name",
    "outside: unexplained",
    *[f"wrong among names with confidence >= {level}" for level in LEVELS],
    WITHIN,
    MISSING,
]


def wilson(hits: int, total: int) -> tuple[float, float]:
    """Return the 95 % interval of a share after Wilson (1927)."""
    if total == 0:
        return 0.0, 1.0
    z, share = 1.959964, hits / total
    middle = (share + z * z / (2 * total)) / (1 + z * z / total)
    half = z / (1 + z * z / total) * math.sqrt(share * (1 - share) / total + z * z / (4 * total * total))
    return max(0.0, middle - half), min(1.0, middle + half)


def _split_name(text: str) -> tuple[str, str | None]:
    """Return name and discrete parameter of "tof_mount_yaw[left]"; the second is None without a bracket."""
    match = re.fullmatch(r"\s*([A-Za-z0-9_]+)\s*(?:\[([^\]]*)\])?\s*", text)
    return (match.group(1), match.group(2)) if match else (text, None)


def _explains_as_well(effect: Named, text: str, parameters: Parameters) -> bool:
    """Return whether the truth lists a name with its discrete parameter as equal to the true effect."""
    name, bracket = _split_name(text)
    answered = next((str(parameters[key]) for key in DISCRETE if parameters.get(key) is not None), bracket)
    equal = [_split_name(each) for each in effect.get("equal", [])]
    return any(name == each and (None in {answered, value} or answered == value) for each, value in equal)


def _same(effect: Named, text: str, parameters: Parameters) -> bool:
    """Return whether a name with its parameters is the true effect, or explains the data as well."""
    if _explains_as_well(effect, text, parameters):
        return True
    name, bracket = _split_name(text)
    if name != effect["name"]:
        return False
    for key in set(DISCRETE) & set(effect["parameters"]):
        answered = parameters.get(key, bracket)
        if answered is not None and str(answered) != str(effect["parameters"][key]):
            return False
    return True


def _directly(effect: Named, named: Named) -> bool:
    """Return whether the answer's name is the effect."""
    return _same(effect, str(named.get("name", "")), named.get("parameters") or {})


def _among(effect: Named, named: Named) -> bool:
    """Return whether the effect is the answer's name or one of at most three names in all."""
    others = named.get("ambiguous_with") or []
    return _directly(effect, named) or (len(others) <= 2 and any(_same(effect, str(o), {}) for o in others))


def _is_number(value: object) -> bool:
    """Return whether an answer's value is a number."""
    return isinstance(value, int | float)


def _product_hits(effect: Named, named: Named) -> tuple[int, int]:
    """Return hits and judged for two parameters of which the data show only the product."""
    values, std = named.get("parameters") or {}, named.get("std") or {}
    log_error, variance = 0.0, 0.0
    for key in PRODUCTS.get(effect["name"], ()):
        if not _is_number(values.get(key)) or not values[key] > 0:
            return 0, 0
        log_error += math.log(values[key] / effect["parameters"][key])
        if _is_number(std.get(key)) and std[key] > 0:
            variance += (std[key] / values[key]) ** 2
    return (int(abs(log_error) <= 3 * math.sqrt(variance)), 1) if variance > 0 else (0, 0)


def parameter_hits(effect: Named, named: Named) -> tuple[int, int]:
    """Return how many numeric parameters are within three standard errors, and how many come with one."""
    if _explains_as_well(effect, str(named.get("name", "")), named.get("parameters") or {}):
        return 0, 0
    hits, judged = _product_hits(effect, named)
    values, std = named.get("parameters") or {}, named.get("std") or {}
    skipped = set(PRODUCTS.get(effect["name"], ()))
    if "angle_by_trial_rad" in effect["parameters"]:
        skipped.add("angle_rad")
    for key, true in effect["parameters"].items():
        if key in skipped or not (_is_number(true) and _is_number(values.get(key)) and _is_number(std.get(key))):
            continue
        if not std[key] > 0:
            continue
        error = values[key] - true
        if key in PERIODIC:
            error = (error + math.pi) % (2 * math.pi) - math.pi
        judged += 1
        hits += abs(error) <= 3 * std[key]
    return hits, judged


def _grade_one(truth: Truth, named: list[Named]) -> tuple[Marks, bool]:
    """Grade a case with one effect, and return whether it is right."""
    effect = truth["effects"][0]
    right, exact = bool(named) and _among(effect, named[0]), bool(named) and _directly(effect, named[0])
    near = bool(named) and _split_name(str(named[0].get("name", "")))[0] in truth.get("near_rivals", {})
    results = (right, exact, exact or near, len(named) > 1)
    return {row: (int(hit), 1) for row, hit in zip(ROWS[:4], results, strict=True)}, right


def _grade_two(truth: Truth, named: list[Named]) -> tuple[Marks, bool]:
    """Grade a case with two effects, and return whether two answers name them."""
    first, second = truth["effects"]
    right = any(_among(first, a) and _among(second, b) for a in named for b in named if a is not b)
    one = any(_among(effect, a) for effect in truth["effects"] for a in named)
    results = (right, len(named) > 2, one)
    return {row: (int(hit), 1) for row, hit in zip(ROWS[4:7], results, strict=True)}, right


def stated_names(truth: Truth, answer: Answer | None) -> list[tuple[float, bool, bool]]:
    """Return the confidence of each name that has one, whether it is right, and whether right or a near rival."""
    names = []
    for named in (answer or {}).get("effects") or []:
        if isinstance(named, dict) and _is_number(named.get("confidence")):
            is_right = any(_directly(effect, named) for effect in truth["effects"])
            is_near = _split_name(str(named.get("name", "")))[0] in truth.get("near_rivals", {})
            names.append((float(named["confidence"]), is_right, is_right or is_near))
    return names


def grade(truth: Truth, answer: Answer | None) -> tuple[Marks, bool]:
    """Grade one case, and return whether it is right; the answer is None where the file is missing."""
    named = [a for a in (answer or {}).get("effects") or [] if isinstance(a, dict)]
    unexplained = bool((answer or {}).get("unexplained", False))
    if truth["category"] == "one":
        marks, right = _grade_one(truth, named)
    elif truth["category"] == "two":
        marks, right = _grade_two(truth, named)
    elif truth["category"] == "none":
        right = not named
        marks = {ROWS[7]: (int(bool(named)), 1), ROWS[8]: (int(unexplained), 1)}
    else:
        right = unexplained and not named
        marks = {ROWS[9]: (int(right), 1), ROWS[10]: (int(unexplained), 1)}
    effects = truth["effects"]
    stated = stated_names(truth, answer)
    for level in LEVELS:
        sure = [is_right for confidence, is_right, _ in stated if confidence >= level]
        marks[f"wrong among names with confidence >= {level}"] = (len(sure) - sum(sure), len(sure))
    first = [next((a for a in named if _directly(effect, a)), None) for effect in effects]
    hits = [parameter_hits(effect, a) for effect, a in zip(effects, first, strict=True) if a is not None]
    marks[WITHIN] = (sum(hit for hit, _ in hits), sum(judged for _, judged in hits))
    marks[MISSING] = (int(answer is None), 1)
    return marks, right


def _answer_line(answer: Answer | None) -> str:
    """Return one line about an answer."""
    if answer is None:
        return "no answer file"
    parts = []
    for named in answer.get("effects") or []:
        confidence, others = named.get("confidence"), named.get("ambiguous_with") or []
        text = f"{named.get('name')}" + (f" ({confidence:.4g})" if _is_number(confidence) else "")
        parts.append(text + (f" or {', '.join(map(str, others))}" if others else ""))
    return (" + ".join(parts) or "no name") + ("; unexplained" if answer.get("unexplained") else "")


def _truth_line(truth: Truth) -> str:
    """Return one line about a truth."""
    effects = [f"{e['name']} (lr {e['lr']:.0f})" for e in truth["effects"] + truth["outside"]]
    factors = {c: f for c, f in truth["disturbances"]["noise_factor"].items() if f != 1}
    near = f"  near rivals {truth['near_rivals']}" if truth.get("near_rivals") else ""
    return (" + ".join(effects) or "nothing") + near + (f"  noise factors {factors}" if factors else "")


def _print_table(group: str, totals: Marks) -> None:
    """Print the shares of one kind or of all."""
    print(f"\n{group}")
    for row in ROWS:
        hits, judged = totals.get(row, (0, 0))
        if judged:
            low, high = wilson(hits, judged)
            print(f"  {row:50s} {hits:4d} of {judged:4d}  {hits / judged:6.1%}  [{low:.1%}, {high:.1%}]")


def answered(truth_path: Path, answers: Path) -> list[tuple[Truth, Answer | None]]:
    """Return the truth of each case of a truth.json, with the answer, or None where the file is missing."""
    cases = []
    for truth in json.loads(truth_path.read_text(encoding="utf-8")):
        path = answers / f"{truth['case']}.json"
        path = path if path.exists() else answers / truth["case"] / "answer.json"
        cases.append((truth, json.loads(path.read_text(encoding="utf-8")) if path.exists() else None))
    return cases


def run(truth_path: Path, answers: Path) -> None:
    """Print the tables and the wrong cases.

    Args:
        truth_path: truth.json of the cases.
        answers: Folder with the answer of each case, as `CASE.json` or `CASE/answer.json`.
    """
    totals: dict[str, Marks] = {}
    wrong = []
    for truth, answer in answered(truth_path, answers):
        marks, right = grade(truth, answer)
        if not right:
            lines = f"true: {_truth_line(truth)} | answer: {_answer_line(answer)}"
            wrong.append(f"{truth['case']} [{truth['category']}] {lines}")
        for group in (truth["kind"], "all"):
            sums = totals.setdefault(group, {})
            for row, (hits, judged) in marks.items():
                before = sums.get(row, (0, 0))
                sums[row] = (before[0] + hits, before[1] + judged)
    for group in sorted(totals, key=lambda g: (g == "all", g)):
        _print_table(group, totals[group])
    print(f"\nwrong cases ({len(wrong)})")
    for line in wrong:
        print("  " + line)
