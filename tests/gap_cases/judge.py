"""What can be known from a case, by the model it was made with: the limit for what a program can find in it.

An effect shows as far as the nominal model with its tolerances cannot imitate it: the expected drop of chi-square is
|P W (mu_with - mu_without) / sigma|^2 over the rows that may be fitted, with W whitening the noise and P projecting out
what deviations of the toleranced parameters can do, each at the price of its prior. The noise of a range sensor may be
the effect; its drop is twice the expected gain in log-likelihood, sum(v - 1 - ln v) over ratios v of variances.

Sigma is the true one, which anybody can learn from the data. Where stated noise and tolerances may be wrong, the judge
knows by how much at most: a tolerance is taken as large as it may be, and a noise that the stated one times an allowed
factor imitates shows nothing.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from . import tof_bench
from .case import Array, Bench, Case, Effect, Frame, World
from .make import KINDS
from .sizes import is_two_sided, rivals

DETECTABLE = 40.0
"""Expected drop above which an effect counts as detectable. With some 20 candidates of up to two parameters, noise
alone takes 15 or so from one of them in one case of a hundred; a drop of expectation 40 has a standard deviation of
2 sqrt(40) = 13, so that 97 of 100 such effects take more than 15."""
NAMELESS = 60.0
"""The same for what is in no table: nobody knows its shape, and a test of some eight shapes at once that is to be right
on effect-free data needs about 30 of it."""
SAME_COSINE = 0.98
NEAR_COSINE = 0.7
"""From which another size is worth a try."""
SAME_DROP = 9.0
"""What is left of an effect after the best size of another may be noise: three standard deviations."""
NUISANCE_STEP = 0.5
"""Tolerances."""
CLEARLY_WRONG = 1.2
"""Factor on the stated noise from which `noise_scale` is there to be reported."""
WORST_SHARE = 0.03
"""Of residuals, left out of E."""


@dataclass(frozen=True)
class Verdict:
    """Attributes:

    drops: Of each effect, the chi-square it is expected to take from the model with all the others.
    equivalent: Of each effect, the variants of names that these data cannot tell from it.
    beyond: Drop of the outside effects together, 0 without one.
    nameless: Of that, what no single name can take.
    gain: 1 - E(true model) / E(nominal) on the hold-out rows.
    excused: Names of what the day did to the data: a report of one is neither right nor wrong.
    """

    drops: tuple[float, ...]
    equivalent: tuple[tuple[str, ...], ...]
    beyond: float
    nameless: float
    gain: float
    excused: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Space:
    """Differences of predictions in whitened sigmas, with the part that nuisances imitate taken out."""

    frame: Frame
    rows: NDArray[np.bool_]
    correlation: Array
    basis: Array
    nuisances: int

    def projected(self, difference: Array) -> Array:
        """(K, n) differences, and below them the prior's rows."""
        white = _white(difference / self.frame.sigma, self.rows, self.frame.run, self.correlation)
        padded = np.concatenate([white, np.zeros((len(white), self.nuisances))], axis=1)
        return padded - (padded @ self.basis) @ self.basis.T


def judge(case: Case, *, with_rivals: bool = True) -> Verdict:
    """Drops, equivalents and gain; without rivals, nothing is equivalent and all of an outside effect is nameless."""
    kind, bench, world = KINDS[case.bench.kind], case.bench, case.world
    frame = kind.frame(case.true_bench, case.columns)
    stated = kind.frame(bench, case.columns)
    hidden = [*world.effects, *([world.outsides] if world.outsides else [])]
    without = [_without(world, each) for each in hidden]
    others = rivals(bench) if with_rivals and hidden else []
    varied = [_nudged(bench, world, name) for name in bench.spreads()]
    worlds = [world, bench.textbook(), *varied, *without]
    means = kind.predict(bench, case.columns, worlds)
    gain = 1.0 - error(stated, means[0]) / error(stated, means[1])
    slopes = case.day.tolerance_limit * (means[2 : 2 + len(varied)] - means[0]) / NUISANCE_STEP
    drops, same, nameless = [], [], 0.0
    for k, each in enumerate(hidden):
        bare = means[2 + len(varied) + k]
        rest = [other for other in world.effects if other is not each]
        free = [_bent(world, other, name) for other in rest for name in _numbers(other)]
        bent = kind.predict(bench, case.columns, free) - means[0] if free else np.zeros((0, len(bare)))
        space = _space(frame, means[0], slopes, bent)
        shape = space.projected((means[0] - bare)[None])[0]
        drop = float(shape @ shape) + _of_spread(case, without[k]) + _of_wander(case, without[k])
        drops.append(drop)
        taken = _rivals(case, kind, space, (without[k], bare), others, shape) if others else {}
        close = {name: (cosine, drop * (1.0 - cosine**2)) for name, cosine in taken.items()}
        if isinstance(each, Effect):
            like = [n for n, (cosine, left) in close.items() if cosine > SAME_COSINE and left < SAME_DROP]
            noisy = _noise_rivals(case, each, without[k], drop)
            same.append(tuple(sorted({*like, *noisy} - {each.variant, *(other.variant for other in rest)})))
        else:
            nameless = min((left for _, left in close.values()), default=drop)
    own = len(world.effects)
    return Verdict(
        tuple(drops[:own]), tuple(same), drops[own] if world.outsides else 0.0, nameless, gain, _excused(case)
    )


def error(frame: Frame, predicted: Array) -> float:
    """E of the format: per stage, the root mean square residual in sigmas without the largest, over the stages."""
    squares = []
    for stage in np.unique(frame.stage):
        counted = (frame.stage == stage) & frame.holdout & np.isfinite(frame.measured) & np.isfinite(predicted)
        z = np.sort(np.abs((frame.measured - predicted) / frame.sigma)[counted])
        kept = z[: len(z) - int(WORST_SHARE * len(z))]
        if len(kept):
            squares.append(float(np.mean(kept**2)))
    return float(np.sqrt(np.mean(squares)))


def _space(frame: Frame, true: Array, slopes: Array, bent: Array) -> _Space:
    residual = (frame.measured - true) / frame.sigma
    rows = ~frame.holdout & np.isfinite(residual) & frame.usable
    correlation = frame.correlation.copy()
    for stage in np.unique(frame.stage[np.isnan(correlation)]):
        of = frame.stage == stage
        z = np.where(rows, np.clip(residual, -4.0, 4.0), 0.0)
        pairs = of[1:] & rows[1:] & rows[:-1] & (frame.run[1:] == frame.run[:-1])
        correlation[of] = np.sum(z[1:][pairs] * z[:-1][pairs]) / max(np.sum(z[1:][pairs] ** 2), 1.0)
    nuisances = len(slopes)
    white = _white(np.concatenate([slopes, bent]) / frame.sigma, rows, frame.run, correlation)
    prior = np.eye(len(white), nuisances)
    columns = np.concatenate([white, prior], axis=1).T
    length = np.linalg.norm(columns, axis=0)
    basis = np.linalg.qr(columns[:, length > 0.0] / length[length > 0.0])[0]
    return _Space(frame, rows, correlation, basis, nuisances)


def _white(values: Array, rows: NDArray[np.bool_], run: NDArray[np.int64], correlation: Array) -> Array:
    """(K, n) with the correlation of neighbours taken out, 0 outside `rows`."""
    follows = np.concatenate([[False], rows[1:] & rows[:-1] & (run[1:] == run[:-1])])
    rho = np.where(follows, correlation, 0.0)
    values = np.where(rows, values, 0.0)
    before = np.concatenate([np.zeros((len(values), 1)), values[:, :-1]], axis=1)
    return np.where(rows, (values - rho * before) / np.sqrt(1.0 - rho**2), 0.0)


def _rivals(
    case: Case, kind: ModuleType, space: _Space, without: tuple[World, Array], others: Sequence[Effect], shape: Array
) -> dict[str, float]:
    """Of every variant of a name, the best cosine of what it does to the data with what the effect did."""
    world, bare = without
    best: dict[str, float] = {}
    others = [each for each in others if each.variant not in {hidden.variant for hidden in world.effects}]
    for resized in (False, True):
        means = kind.predict(case.bench, case.columns, [_with(world, each) for each in others])
        done = space.projected(means - bare)
        power = np.sum(done**2, axis=1)
        inner = done @ shape
        cosine = inner / np.sqrt(np.maximum(power * (shape @ shape), 1e-300))
        for each, value in zip(others, cosine.tolist(), strict=True):
            best[each.variant] = max(best.get(each.variant, 0.0), value)
        if not resized:
            factor = inner / np.maximum(power, 1e-300)
            near = zip(others, factor.tolist(), cosine.tolist(), strict=True)
            others = [_resized(each, f) for each, f, c in near if _may_be(each, c, case.bench)]
        if not others:
            break
    return best


def _may_be(rival: Effect, cosine: float, bench: Bench) -> bool:
    """Whether, in another size, it may do what the effect did."""
    return cosine > NEAR_COSINE or (cosine < -NEAR_COSINE and is_two_sided(rival.name, bench))


def _resized(effect: Effect, factor: float) -> Effect:
    """So many times as large: the first number of the effect is the one that says how large it is."""
    name = _numbers(effect)[0]
    if name in {"limit_A", "saturation_m"}:
        return effect
    neutral = 1.0 if name in {"scale", "gain"} else 0.0
    value = neutral + float(np.clip(factor, -10.0, 10.0)) * (float(effect.parameters[name]) - neutral)
    return Effect(effect.name, {**effect.parameters, name: max(value, 0.05) if neutral else value})


def _of_spread(case: Case, without: World) -> float:
    if case.bench.kind != "tof_bench":
        return 0.0
    return _deviance(_unstated(case, _spread(case, case.world) / _spread(case, without)))


def _of_wander(case: Case, without: World) -> float:
    """What noise of the best level, in rows that do not know of each other, lacks of the true likelihood."""
    sd_m, bare_m = (world.value("range_wander", "sd_m", 0.0) for world in (case.world, without))
    if case.bench.kind != "tof_bench" or sd_m == bare_m:
        return 0.0
    frame = tof_bench.frame(case.true_bench, case.columns)
    rows = ~frame.holdout & np.isfinite(frame.measured)
    apart_s = np.abs(np.subtract.outer(case.columns["t_s"][rows], case.columns["t_s"][rows]))
    slow = sd_m**2 * np.exp(-apart_s / case.world.value("range_wander", "time_constant_s", 1.0))
    parts = 1.0 + np.linalg.eigvalsh(slow / np.outer(frame.sigma[rows], frame.sigma[rows])).clip(0.0)
    return float(len(parts) * np.log(parts.mean()) - np.log(parts).sum())


def _unstated(case: Case, ratio: Array) -> Array:
    """Ratios of true to stated spreads over the best factor that the stated noise may be wrong by."""
    true = case.day.noise.get("polynomial_mm", 1.0) * ratio
    return true / np.clip(np.sqrt(np.mean(true**2)), *case.day.noise_limits)


def _excused(case: Case) -> tuple[str, ...]:
    if case.bench.kind != "tof_bench":
        return ()
    found = []
    if abs(np.log(case.day.noise.get("polynomial_mm", 1.0))) > np.log(CLEARLY_WRONG):
        one_light = len(np.unique(np.round(case.columns["ambient_lux"], -2))) == 1
        found += ["noise_scale", "ambient_noise"] if one_light else ["noise_scale"]
    return (*found, "range_wander") if case.day.wander else tuple(found)


def _spread(case: Case, world: World) -> Array:
    frame = tof_bench.frame(case.bench, case.columns)
    counted = ~frame.holdout & np.isfinite(frame.measured)
    return tof_bench.sd(case.columns, [world])[0][counted]


def _deviance(ratio: Array) -> float:
    return float(np.sum(ratio**2 - 1.0 - 2.0 * np.log(ratio)))


def _noise_rivals(case: Case, effect: Effect, without: World, drop: float) -> list[str]:
    """Which of the two effects on the noise of a range sensor does as well as the other."""
    keys = {"noise_scale": "scale", "ambient_noise": "coefficient_per_klux"}
    if case.bench.kind != "tof_bench" or effect.name not in keys:
        return []
    true, found = _spread(case, case.world), []
    for name, key in keys.items():
        sizes = np.geomspace(0.02, 50.0, 200) if name == "ambient_noise" else np.geomspace(0.15, 8.0, 300)
        worlds = [_with(without, Effect(name, {key: float(size)})) for size in sizes]
        left = min(_deviance(_unstated(case, true / _spread(case, each))) for each in worlds)
        if left < SAME_DROP and left < (1.0 - SAME_COSINE**2) * drop:
            found.append(name)
    return found


def _numbers(effect: Effect) -> list[str]:
    return [name for name, value in effect.parameters.items() if not isinstance(value, str)]


def _with(world: World, effect: Effect) -> World:
    return replace(world, effects=(*world.effects, effect))


def _without(world: World, hidden: object) -> World:
    if hidden is world.outsides:
        return replace(world, outsides=())
    return replace(world, effects=tuple(each for each in world.effects if each is not hidden))


def _nudged(bench: Bench, world: World, name: str) -> World:
    own = {**world.own, name: world.own[name] + NUISANCE_STEP * bench.spreads()[name][1]}
    return replace(world, own=own)


def _bent(world: World, effect: Effect, name: str) -> World:
    """The world with one number of an effect changed by a hundredth."""
    changed = Effect(effect.name, {**effect.parameters, name: 1.01 * float(effect.parameters[name])})
    return replace(world, effects=tuple(changed if each is effect else each for each in world.effects))
