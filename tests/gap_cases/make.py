"""A case from a kind, a seed and what is to be hidden in it."""

from collections.abc import Mapping, Sequence
from types import ModuleType

import numpy as np

from . import drive_log, motor_steady, motor_step, tof_bench
from .beyond import BEYOND
from .case import Bench, Case, Effect, Outside, Value, World
from .sizes import sample

KINDS: Mapping[str, ModuleType] = {
    "motor_steady": motor_steady,
    "motor_step": motor_step,
    "tof_bench": tof_bench,
    "drive_log": drive_log,
}


def draw_bench(kind: str, seed: int, rows: str = "usual") -> Bench:
    """What is known beforehand of the case of that seed."""
    return KINDS[kind].draw(_stream(kind, seed, "bench"), rows)


def draw_effect(name: str, bench: Bench, seed: int, word: str | None = None) -> Effect:
    """A size for the effect, and its discrete parameter where it has one that is not given."""
    return sample(name, bench, _stream(bench.kind, seed, name), word)


def draw_outside(name: str, bench: Bench, seed: int) -> Outside:
    return BEYOND[bench.kind][name](_stream(bench.kind, seed, name), bench)


def make_case(
    kind: str,
    seed: int,
    effects: Sequence[tuple[str, Mapping[str, Value] | None] | Effect] = (),
    outside: str | Outside | None = None,
    rows: str = "usual",
) -> Case:
    """A case that is the same for the same arguments.

    Args:
        kind: One of `KINDS`.
        seed: Of everything that is drawn.
        effects: Names with parameters; None for those drawn by the seed.
        outside: In no table: its name, or all of it.
        rows: `usual` or `few`.
    """
    bench = draw_bench(kind, seed, rows)
    hidden = tuple(_effect(each, bench, seed) for each in effects)
    strange = draw_outside(outside, bench, seed) if isinstance(outside, str) else outside
    rng = _stream(kind, seed, "unit")
    own = {name: value + tolerance * rng.standard_normal() for name, (value, tolerance) in bench.spreads().items()}
    world = World(own, hidden, strange)
    columns, blind = KINDS[kind].observe(bench, world, _stream(kind, seed, "noise"))
    return Case(f"{kind}_{seed}", bench, columns, blind, world)


def _effect(given: tuple[str, Mapping[str, Value] | None] | Effect, bench: Bench, seed: int) -> Effect:
    if isinstance(given, Effect):
        return given
    name, parameters = given
    return Effect(name, parameters) if parameters is not None else draw_effect(name, bench, seed)


def _stream(kind: str, seed: int, purpose: str) -> np.random.Generator:
    return np.random.default_rng([seed, *f"{kind}/{purpose}".encode()])
