"""A case from a kind, a seed and what is to be hidden in it."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import ModuleType

import numpy as np

from . import drive_log, motor_steady, motor_step, tof_bench
from .beyond import BEYOND
from .beyond_wide import WIDE_BEYOND
from .case import Bench, Case, Effect, Outside, Value, World
from .disturbances import FAMILIES
from .sizes import sample

KINDS: Mapping[str, ModuleType] = {
    "motor_steady": motor_steady,
    "motor_step": motor_step,
    "tof_bench": tof_bench,
    "drive_log": drive_log,
}


def draw_bench(kind: str, seed: int, rows: str = "usual", family: str = "narrow") -> Bench:
    """What is known beforehand of the case of that seed."""
    return KINDS[kind].draw(_stream(kind, seed, "bench", family), rows)


def draw_effect(name: str, bench: Bench, seed: int, word: str | None = None, family: str = "narrow") -> Effect:
    """A size for the effect, and its discrete parameter where it has one that is not given."""
    rng = _stream(bench.kind, seed, name, family)
    return sample(name, bench, rng, word, is_wide=FAMILIES[family].is_wide)


def draw_outside(name: str, bench: Bench, seed: int, family: str = "narrow") -> Outside:
    samplers = BEYOND[bench.kind] | WIDE_BEYOND[bench.kind]
    return samplers[name](_stream(bench.kind, seed, name, family), bench)


def outside_names(kind: str, family: str) -> list[str]:
    """Effects in no table that cases of the family may have."""
    return list((WIDE_BEYOND if FAMILIES[family].is_wide else BEYOND)[kind])


def make_case(
    kind: str,
    seed: int,
    effects: Sequence[tuple[str, Mapping[str, Value] | None] | Effect] = (),
    outside: str | Outside | Sequence[str] | None = None,
    rows: str = "usual",
    family: str = "narrow",
) -> Case:
    """A case that is the same for the same arguments.

    Args:
        kind: One of `KINDS`.
        seed: Of everything that is drawn.
        effects: Names with parameters; None for those drawn by the seed.
        outside: In no table: its name, all of it, or several names.
        rows: `usual`, `some` or `few`.
        family: One of `FAMILIES`.
    """
    bench = draw_bench(kind, seed, rows, family)
    hidden = tuple(_effect(each, bench, seed, family) for each in effects)
    strange = [outside] if isinstance(outside, str | Outside) else outside or ()
    drawn = tuple(each if isinstance(each, Outside) else draw_outside(each, bench, seed, family) for each in strange)
    spreads = bench.spreads()
    day = FAMILIES[family].day(bench.nominal, list(spreads), _stream(kind, seed, "day", family))
    if any(each.name == "noise_scale" for each in hidden):
        day = replace(day, noise={})  # its scale is then all that the stated noise is wrong by
    rng = _stream(kind, seed, "unit", family)
    own = {
        name: value + day.tolerance.get(name, 1.0) * tolerance * rng.standard_normal()
        for name, (value, tolerance) in spreads.items()
    }
    case = Case(f"{kind}_{seed}", bench, {}, {}, World(own, hidden, drawn), day)
    columns, blind = KINDS[kind].observe(case.true_bench, case.world, _stream(kind, seed, "noise", family), day)
    return replace(case, columns=columns, blind=blind)


def _effect(given: tuple[str, Mapping[str, Value] | None] | Effect, bench: Bench, seed: int, family: str) -> Effect:
    if isinstance(given, Effect):
        return given
    name, parameters = given
    return Effect(name, parameters) if parameters is not None else draw_effect(name, bench, seed, family=family)


def _stream(kind: str, seed: int, purpose: str, family: str) -> np.random.Generator:
    within = "" if family == "narrow" else f"{family}/"
    return np.random.default_rng([seed, *f"{within}{kind}/{purpose}".encode()])
