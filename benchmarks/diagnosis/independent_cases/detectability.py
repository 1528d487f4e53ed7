"""Likelihood ratios that decide how large an effect is drawn.

Let s be the white difference of all fit rows between the predictions with and without the effect, in the standard
deviations that the case really has: its noise factor and any effect of the noise are in them, outliers are not. What
the individual parameters could explain within their tolerances is projected out:

    LR = min over d of |s - J d|^2 + |d|^2,

where J is the change of the prediction by one tolerance of each nominal parameter. This is twice the expected gain of
log likelihood of the true model over the best robot without that effect. One effect alone gets an LR that is
log-uniform between 30 and 3000. In a pair, the parameters of the other effect are projected out freely, and each LR
is at least 30. An outside effect keeps LR > 60 also where any one listed name is projected out freely. The LR of an
effect of the noise is twice the Kullback-Leibler divergence between the Gaussian models with and without it.
"""

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from benchmarks.diagnosis.independent_cases.draws import log_uniform
from benchmarks.diagnosis.independent_cases.recipes import Array, Effect, Parameters, Recipe, Sized, Variant, variant_of
from benchmarks.diagnosis.independent_cases.setting import Setting

LOW, HIGH, OUTSIDE_LOW = 30.0, 3000.0, 60.0
GRID = 8


def left_over(difference: Array, within: Sequence[Array], free: Sequence[Array] = ()) -> float:
    """Return the LR of a difference (values,) beside columns with a unit prior (`within`) and without one (`free`)."""
    columns = [*within, *free]
    total = float(difference @ difference)
    if not columns:
        return total
    matrix = np.stack(columns)
    gram = matrix @ matrix.T
    # Free columns may be parallel, so that they get a prior that is too weak to matter.
    prior = np.concatenate([np.ones(len(within)), 1e-9 * (1e-12 + np.diag(gram)[len(within) :])])
    cross = matrix @ difference
    solution = np.linalg.lstsq(gram + np.diag(prior), cross, rcond=None)[0]
    return max(total - float(cross @ solution), 0.0)


def tolerance_variants(setting: Setting) -> list[Variant]:
    """Return one robot per nominal parameter, with that parameter shifted by one tolerance."""
    return [Variant(shifts={name: 1.0}) for name in setting.tolerance_names]


def _size_for(target: float, sizes: Array, measured: Sequence[float]) -> float | None:
    """Interpolate the size with that LR between measured ones; return None where even the largest is below LOW."""
    ratios = np.maximum(np.asarray(measured, float), 1e-12)
    if np.max(ratios) < LOW:
        return None
    if ratios[0] > target:
        return float(sizes[0] * np.sqrt(target / ratios[0]))
    above = np.nonzero(ratios >= target)[0]
    if len(above) == 0:
        return float(sizes[int(np.argmax(ratios))])
    i = int(above[0])
    part = np.log(target / ratios[i - 1]) / np.log(ratios[i] / ratios[i - 1])
    return float(sizes[i - 1] * (sizes[i] / sizes[i - 1]) ** part)


def _noise_effects(setting: Setting, sized: Iterable[tuple[Recipe, float | None]]) -> list[Effect]:
    """Return the effects of the noise among those whose size is known."""
    return [recipe.effect(size) for recipe, size in sized if recipe.name in setting.IN_NOISE and size is not None]


def _grid(recipe: Recipe) -> Array:
    """Return the sizes that an LR is computed for."""
    return np.geomspace(recipe.low, recipe.high, GRID)


def _noise_sizes(setting: Setting, recipes: Sequence[Recipe], targets: Sequence[float]) -> list[float | None] | None:
    """Size the effects of the noise, each beside those before it; return None where one cannot be seen."""
    sizes: list[float | None] = [1.0 if r.fixed and r.name in setting.IN_NOISE else None for r in recipes]
    for i, (recipe, target) in enumerate(zip(recipes, targets, strict=True)):
        if recipe.name in setting.IN_NOISE and not recipe.fixed:
            others = _noise_effects(setting, zip(recipes, sizes, strict=True))
            ratios = [setting.noise_ratio(recipe.effect(size), others) for size in _grid(recipe)]
            sizes[i] = _size_for(target, _grid(recipe), ratios)
            if sizes[i] is None:
                return None
    return sizes


def solve_sizes(setting: Setting, recipes: Sequence[Recipe], targets: Sequence[float]) -> Sized | None:
    """Give each recipe the size at which it has its target LR alone; return None where one cannot be detected."""
    sizes = _noise_sizes(setting, recipes, targets)
    if sizes is None:
        return None
    unsized = [i for i, size in enumerate(sizes) if size is None]
    if unsized:
        within = tolerance_variants(setting)
        grown = [variant_of([(recipes[i], size)]) for i in unsized for size in _grid(recipes[i])]
        noise_effects = _noise_effects(setting, zip(recipes, sizes, strict=True))
        # One batch for all, since a batch costs little more than one prediction.
        signatures = setting.signatures([Variant(), *within, *grown], noise_effects)
        columns = [s - signatures[0] for s in signatures[1 : 1 + len(within)]]
        rows = signatures[1 + len(within) :]
        for number, i in enumerate(unsized):
            ratios = [left_over(row - signatures[0], columns) for row in rows[GRID * number : GRID * (number + 1)]]
            size = _size_for(targets[i], _grid(recipes[i]), ratios)
            if size is None:
                return None
            size = max(size, recipes[i].low) if recipes[i].clamped else size
            sizes[i] = 1.0 if recipes[i].fixed else size
    return [(recipe, size) for recipe, size in zip(recipes, sizes, strict=True) if size is not None]


def _changed_parameters(parameters: Parameters) -> Iterator[Parameters]:
    """Yield copies of the parameters with one continuous parameter changed by 5 % each."""
    for key, value in parameters.items():
        if isinstance(value, float) and value != 0 and np.isfinite(value):
            yield {**parameters, key: value * 1.05}


def _changed_variants(sized: Sized, number: int) -> list[Variant]:
    """Return robots with all effects, one parameter of the effects other than that number changed each."""
    variants = []
    full = variant_of(sized)
    for other, size in sized[:number] + sized[number + 1 :]:
        for changed in _changed_parameters(other.parameters(size)):
            effects, outside = (
                tuple(Effect(e.name, changed) if e.name == other.name else e for e in group)
                for group in (full.effects, full.outside)
            )
            variants.append(Variant(effects, outside))
    return variants


def ratios_beside(setting: Setting, sized: Sized) -> list[float]:
    """Return the LR of every effect beside the others, whose parameters are free."""
    within = tolerance_variants(setting)
    variants = [variant_of(sized), *within]
    marks = []
    for i in range(len(sized)):
        first = len(variants)
        variants += [variant_of(sized[:i] + sized[i + 1 :]), *_changed_variants(sized, i)]
        marks.append((first, len(variants)))
    signatures = setting.signatures([*variants, Variant()], _noise_effects(setting, sized))
    full, base = signatures[0], signatures[-1]
    columns = [s - base for s in signatures[1 : 1 + len(within)]]
    ratios = []
    for i, ((recipe, size), (first, end)) in enumerate(zip(sized, marks, strict=True)):
        if recipe.name in setting.IN_NOISE:
            others = _noise_effects(setting, sized[:i] + sized[i + 1 :])
            ratios.append(setting.noise_ratio(recipe.effect(size), others))
        else:
            free = [s - full for s in signatures[first + 1 : end]]
            ratios.append(left_over(full - signatures[first], columns, free))
    return ratios


def ratios_beside_names(setting: Setting, sized: Sized, rng: np.random.Generator) -> dict[str, float]:
    """Return the LR that the effects keep where one listed name is fitted freely, and "(no name)" for none.

    A name is linearised around two drawn sizes. Where it has several continuous parameters, it may use both columns.
    """
    within = tolerance_variants(setting)
    variants = [Variant(), variant_of(sized), *within]
    marks: dict[str, tuple[int, bool]] = {}
    for name in setting.rival_names:
        if any(name == recipe.name for recipe, _ in sized):
            continue
        first, recipe = len(variants), None
        for _ in range(2):
            recipe = setting.recipe(name, rng)
            size = 1.0 if recipe.fixed else log_uniform(rng, recipe.low, (recipe.low * recipe.high) ** 0.5)
            variants.append(variant_of([(recipe, size)]))
        marks[name] = first, recipe is not None and _continuous(recipe) > 1
    signatures = setting.signatures(variants, ())
    base = signatures[0]
    columns = [s - base for s in signatures[2 : 2 + len(within)]]
    difference = signatures[1] - base
    best = {"(no name)": left_over(difference, columns)}
    for name, (first, together) in marks.items():
        free = [s - base for s in signatures[first : first + 2]]
        attempts = [free] if together else [[column] for column in free]
        best[name] = min(left_over(difference, columns, attempt) for attempt in attempts)
    return best


def _continuous(recipe: Recipe) -> int:
    """Count the continuous parameters."""
    return sum(isinstance(value, float) for value in recipe.parameters(1.0).values())
