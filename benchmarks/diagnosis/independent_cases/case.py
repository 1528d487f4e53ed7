"""One case: settings and effect sizes are drawn until every effect is detectable, then the data."""

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from benchmarks.diagnosis.independent_cases import detectability
from benchmarks.diagnosis.independent_cases.beyond import Worsen
from benchmarks.diagnosis.independent_cases.detectability import HIGH, LOW, OUTSIDE_LOW
from benchmarks.diagnosis.independent_cases.draws import log_uniform
from benchmarks.diagnosis.independent_cases.drives.drive_log import DriveSetting
from benchmarks.diagnosis.independent_cases.motors.motor_steady import SteadySetting
from benchmarks.diagnosis.independent_cases.motors.motor_step import StepSetting
from benchmarks.diagnosis.independent_cases.ranges.tof_bench import RangeSetting
from benchmarks.diagnosis.independent_cases.recipes import Recipe, Sized, variant_of
from benchmarks.diagnosis.independent_cases.setting import CaseFiles, Setting
from benchmarks.diagnosis.independent_cases.shares import deal_categories, deal_names

KINDS: dict[str, type[Setting]] = {
    setting.KIND: setting for setting in (SteadySetting, StepSetting, RangeSetting, DriveSetting)
}
ATTEMPTS = 60
NEAR = 12.0  # a name beside which less LR than this remains is a near rival


def _grown(sized: Sized, ratios: list[float]) -> Sized:
    """Return larger sizes for effects whose LR is too small; LR grows about as the square of the size."""
    larger = []
    for (recipe, size), ratio in zip(sized, ratios, strict=True):
        factor = max(1.0, (1.3 * LOW / max(ratio, 1e-3)) ** 0.5)
        larger.append((recipe, size if recipe.fixed else min(recipe.high, size * factor)))
    return larger


def _size(
    setting: Setting, recipes: list[Recipe], targets: list[float], category: str
) -> tuple[Sized, list[float]] | None:
    """Return the recipes with sizes, and their LR; None where this setting cannot show them."""
    sized = detectability.solve_sizes(setting, recipes, targets)
    if sized is None:
        return None
    ratios = detectability.ratios_beside(setting, sized)
    for _ in range(3 if category != "one" else 0):
        if min(ratios) >= LOW:
            break
        larger = _grown(sized, ratios)
        if larger == sized:
            break
        sized = larger
        ratios = detectability.ratios_beside(setting, sized)
    if min(ratios) < LOW or not setting.plausible(variant_of(sized)):
        return None
    return sized, ratios


@dataclass(frozen=True)
class Drawn:
    """A setting and the effects that it shows."""

    setting: Setting
    sized: Sized
    ratios: list[float]
    rivals: dict[str, float]  # LR beside every listed name, for an outside effect and one effect on the mean


def _draw_once(
    kind: type[Setting], category: str, names: list[str], rng: np.random.Generator, worsen: Worsen | None
) -> Drawn | None:
    """Draw a setting and sizes; return None where the setting cannot show the effects."""
    setting = kind(rng)
    if worsen is not None:
        worsen(setting, rng)
    if not setting.prepare(names, rng):
        return None
    recipes = [setting.recipe(name, rng) for name in names]
    low = OUTSIDE_LOW * 2 if category == "outside" else LOW
    targets = [log_uniform(rng, low, HIGH) for _ in names]
    if not names:
        return Drawn(setting, [], [], {})
    solved = _size(setting, recipes, targets, category)
    if solved is None:
        return None
    sized, ratios = solved
    rivals = {}
    if category == "outside" or (category == "one" and names[0] not in setting.IN_NOISE):
        rivals = detectability.ratios_beside_names(setting, sized, rng)
    if category == "outside" and min(rivals.values()) < OUTSIDE_LOW:
        return None
    return Drawn(setting, sized, ratios, rivals)


def _entries(drawn: Drawn) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Return what truth.json reports about the listed and the outside effects."""
    effects, outside = [], []
    for (recipe, size), ratio in zip(drawn.sized, drawn.ratios, strict=True):
        entry = {"name": recipe.name, "parameters": recipe.parameters(size), "lr": round(ratio, 1)}
        if recipe.place != "outside":
            effects.append(entry)
            continue
        nearest = min(drawn.rivals, key=lambda name: drawn.rivals[name])
        entry |= {"description": recipe.description, "channel": recipe.channel, "covariate": recipe.covariate}
        entry |= {
            "lr_of_all": round(drawn.rivals["(no name)"], 1),
            "lr_beside_nearest_name": round(drawn.rivals[nearest], 1),
            "nearest_name": nearest,
        }
        outside.append(entry)
    return effects, outside


def draw_case(
    kind: type[Setting], category: str, names: list[str], rng: np.random.Generator, worsen: Worsen | None = None
) -> tuple[Drawn, int]:
    """Return the setting and the effects of one case, and the number of settings that were tried.

    Raises RuntimeError where no setting of many shows the effects.
    """
    attempts = ((attempt, _draw_once(kind, category, names, rng, worsen)) for attempt in range(1, ATTEMPTS + 1))
    attempt, drawn = next((pair for pair in attempts if pair[1] is not None), (ATTEMPTS, None))
    if drawn is None:
        raise RuntimeError(f"{kind.KIND}: {names} is not detectable in {ATTEMPTS} settings; use another seed")
    return drawn, attempt


def make_case(
    kind: type[Setting], category: str, names: list[str], rng: np.random.Generator, worsen: Worsen | None
) -> tuple[CaseFiles, CaseFiles, dict[str, Any]]:
    """Return the files of one case, those of the same measurement with other noise, and its entry of truth.json."""
    drawn, attempt = draw_case(kind, category, names, rng, worsen)
    setting = drawn.setting
    files, again = (setting.produce(variant_of(drawn.sized), rng) for _ in range(2))
    effects, outside = _entries(drawn)
    near = {name: round(ratio, 1) for name, ratio in drawn.rivals.items() if category == "one" and ratio < NEAR}
    truth = {
        "kind": setting.KIND,
        "category": category,
        "effects": effects,
        "outside": outside,
        "near_rivals": near,
        "individual": setting.individual,
        "tolerance_factor": setting.tolerance_factor,
        "disturbances": asdict(setting.plan),
        "setting": setting.describe(),
        "attempts": attempt,
    }
    return files, again, truth


def deal_cases(kind: str, count: int, seed: int) -> Iterator[tuple[str, list[str], np.random.Generator]]:
    """Yield the category, the names and the random stream of `count` cases."""
    number = sorted(KINDS).index(kind)
    dealer = np.random.default_rng([seed, number])
    categories = deal_categories(dealer, count)
    names = deal_names(dealer, categories, KINDS[kind].PLACE, KINDS[kind].OUTSIDE)
    for i, category in enumerate(categories):
        yield category, names[i], np.random.default_rng([seed, number, i])


def make_cases(
    kind: str, count: int, seed: int, worsen: Worsen | None = None
) -> Iterator[tuple[CaseFiles, CaseFiles, dict[str, Any]]]:
    """Yield the files, those of the same measurement again, and the truth of `count` cases; the same for the same
    arguments.
    """
    number = sorted(KINDS).index(kind)
    for i, (category, names, rng) in enumerate(deal_cases(kind, count, seed)):
        files, again, truth = make_case(KINDS[kind], category, names, rng, worsen)
        yield files, again, {"case": f"{kind}_{i + 1:03d}", "seed": [seed, number, i], **truth}
