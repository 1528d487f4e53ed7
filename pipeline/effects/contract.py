"""The contract of an effect: rules that every one keeps, shipped or a user's own, each with what it means.

`symolo effect check` and `tests/contracts/test_effects.py` use these rules.
"""

from collections.abc import Iterator, Sequence
from itertools import islice
from typing import Any

import numpy as np
from pydantic import ValidationError

from configs.effects.base import Effect, Setup
from configs.families import last_call
from configs.schema.robot import RobotConfig
from pipeline.effects.calls import Call, frozen, numbers_in, rows_of
from pipeline.effects.closest import SAME_SHARE, closest
from pipeline.effects.probe import ABOUT, Readings, equal
from pipeline.effects.trial import EffectTrial
from pipeline.rules import BrokenRule, Rule, RuleVerdict, verdicts
from symolo.core.arrays import Array

LONGEST_BOUND = 1e5
MIN_TEXT = 10
SAME = 1e-9
"""Relative difference of numbers that were computed in another order."""
OF_STEPS = 0.4
"""Largest share of the effect on the path that a step of half the length may change. It changes 0 to 8 % for shipped
effects and 28 % for a current limit, and 50 % for a law that multiplies by the turn of a step."""
FACTORS = frozenset({"scale", "gain", "height_scale"})
"""Names of parameters that multiply, whose null value is 1."""


def judged(trial: EffectTrial, rules: Sequence[Rule[EffectTrial]] | None = None) -> Iterator[RuleVerdict]:
    """Yield the verdict of each rule; an error in the effect's function is one as well."""
    return verdicts(trial, RULES if rules is None else rules, lambda error: place_and_text(error, trial.effect))


def place_and_text(error: BaseException, effect: type[Effect]) -> str:
    """Return the line of the effect's file where an error was raised, with its text."""
    text = f"{type(error).__name__}: {error}"
    if call := last_call(error, effect.apply.__code__.co_filename):
        return f"apply fails in line {call.lineno}: {text}"
    return f"the result of apply cannot be used: {text}; return the first argument, changed, in the same form"


def _texts(trial: EffectTrial) -> None:
    effect = trial.effect
    for name in ("cause", "excitation"):
        text = getattr(effect, name)
        if not isinstance(text, str) or len(text) <= MIN_TEXT:
            raise BrokenRule(f"{name} is {text!r}: write a text of more than {MIN_TEXT} characters")
    setups: Any = effect.setups
    if not isinstance(setups, tuple) or not all(isinstance(setup, Setup) for setup in setups):
        allowed = ", ".join(f"Setup.{setup.name}" for setup in Setup)
        raise BrokenRule(f"setups is {setups!r}: write a tuple of some of {allowed}")


def _bounds(trial: EffectTrial) -> None:
    for name, number in trial.effect.parameters().items():
        if not -LONGEST_BOUND < number.low < number.start < number.high < LONGEST_BOUND:
            order = f"-{LONGEST_BOUND:g} < low < start < high < {LONGEST_BOUND:g}"
            raise BrokenRule(f"{name}: low={number.low:g}, start={number.start:g}, high={number.high:g}: needs {order}")
        if number.null is None:
            continue
        if not number.low <= number.null <= number.high:
            raise BrokenRule(f"{name}: null={number.null:g} is outside {number.low:g} ... {number.high:g}")
        if number.null == number.start:
            raise BrokenRule(f"{name}: the start is the null value, at which nothing shows: choose another start")
        if name in FACTORS and number.null != 1.0:
            raise BrokenRule(f"{name}: a factor has the null value 1, not {number.null:g}")


def _units(trial: EffectTrial) -> None:
    for name, number in trial.effect.parameters().items():
        if not number.unit.strip():
            raise BrokenRule(f"{name}: no unit; write '1' for a number without one")
        endings = spelled(number.unit)
        if number.unit == "1":
            if name.endswith(("_s", "_m", "_V", "_A", "_rad")):
                raise BrokenRule(f"{name}: the name ends in a unit, and the unit is '1'")
        elif not name.endswith(endings):
            raise BrokenRule(f"{name}: the unit is {number.unit!r}, so the name ends in _{' or _'.join(endings)}")


def spelled(unit: str) -> tuple[str, ...]:
    """Return a unit as the end of a name: `m/K` is `m_per_K` or `m_K`, `1/m` is `per_m` or `1_m`."""
    words = unit.replace("1/min", "1/minute").replace("sqrt(m)", "sqrt_m").replace(" ", "_")
    inverse = [words.replace("1/", start) for start in ("per_", "1_")]
    return tuple(dict.fromkeys(each.replace("/", sign) for each in inverse for sign in ("_per_", "_")))


def _settings(trial: EffectTrial) -> None:
    effect = trial.effect
    robot = trial.robot(trial.start)
    if robot.model_dump()["effects"] != {effect.name: trial.start.model_dump()}:
        raise BrokenRule("the settings of the robot do not show the given values: keep them as they are")
    if RobotConfig.model_validate_json(robot.model_dump_json()) != robot:
        raise BrokenRule(
            "written as JSON and read again, the effect has other values: its fields may be numbers and texts"
        )
    for name, number in effect.parameters().items():
        for inside in (number.low, number.high):
            _validated(effect, {**trial.start.model_dump(), name: inside}, name)
        step = 0.01 * (number.high - number.low)
        for outside in (number.low - step, number.high + step, float("nan")):
            try:
                effect.model_validate({**trial.start.model_dump(), name: outside})
            except ValidationError:
                continue
            raise BrokenRule(f"{name}: {outside:g} is accepted, outside {number.low:g} ... {number.high:g}")


def _validated(effect: type[Effect], values: dict[str, Any], name: str) -> None:
    try:
        effect.model_validate(values)
    except ValidationError as error:
        why = error.errors()[0]["msg"]
        raise BrokenRule(f"{name}: {values[name]:g} is refused, within its bounds: {why}") from None


def _form(trial: EffectTrial) -> None:
    calls = trial.calls
    if not calls:
        raise BrokenRule(f"no experiment calls a function in the slot '{trial.effect.slot}'")
    for call in calls:
        first, result = call.arguments[0], call.result
        if type(result) is not type(first) and not (_is_number(first) and _is_number(result)):
            types = f"apply returns {type(result).__name__}, and its first argument is {type(first).__name__}"
            raise BrokenRule(f"{types}: return that argument, changed")
        for argument, changed in zip(numbers_in(first), numbers_in(result), strict=True):
            if np.broadcast_shapes(argument.shape, changed.shape) != changed.shape:
                raise BrokenRule(f"apply returns an array of shape {changed.shape} in the place of {argument.shape}")


def _is_number(value: Any) -> bool:  # noqa: ANN401 - whatever a function returns
    return isinstance(value, (float, int, np.ndarray, np.generic))


def _pairs(some: Any, others: Any) -> Iterator[tuple[Array, Array]]:  # noqa: ANN401 - as above
    yield from zip(numbers_in(some), numbers_in(others), strict=False)


def _null(trial: EffectTrial) -> None:
    for place in trial.places():
        bare, null = trial.bare(place), trial.read(place, trial.effect.null(trial.choices))
        if not equal(bare, null):
            change = f"{_first_change(bare, null)} on the {place}"
            raise BrokenRule(f"at the null values {change}: apply must then return its first argument")


def _first_change(some: Readings, others: Readings) -> str:
    for name, values in some.items():
        if values.tobytes() != others[name].tobytes():
            change = np.nanmax(np.abs(others[name].astype(float) - values), initial=0.0)
            return f"the reading {name} changes by {change:.3g}" if change else f"the reading {name} has other bits"
    return "nothing changes"


def _start(trial: EffectTrial) -> None:
    changed = {place for place in trial.places() if not equal(trial.bare(place), trial.at_start[place])}
    if not changed:
        raise BrokenRule(f"at the start values no reading changes ({'; '.join(ABOUT)}); is there a larger start?")
    if "engine" in trial.places() and "engine" not in changed and "twin" in changed:
        raise BrokenRule("it changes the twin, and not PyBullet: compute it from the arguments of apply alone")


def _pure(trial: EffectTrial) -> None:
    for call in trial.calls:
        arguments = frozen(call.arguments)
        again = [trial.start.apply(*arguments), trial.start.apply(*frozen(call.arguments))]
        if any(not np.array_equal(x, y, equal_nan=True) for x, y in _pairs(arguments, call.arguments)):
            raise BrokenRule("apply changes an array that it was given: compute a new one, without += or indices")
        if any(not np.array_equal(x, y, equal_nan=True) for r in again for x, y in _pairs(r, call.result)):
            raise BrokenRule("the same arguments give another result: no random numbers, no memory between calls")


def _repeats(trial: EffectTrial) -> None:
    for place in {"twin", "bench"} & trial.places().keys():
        if not equal(trial.read(place, trial.start), trial.at_start[place]):
            raise BrokenRule(f"the same experiment on the {place} gives other readings when it is done again")


def _finite(trial: EffectTrial) -> None:
    for name, changed in trial.other_values():
        for call in trial.calls:
            with np.errstate(all="ignore"):
                result = changed.apply(*frozen(call.arguments))
            if not all(np.all(np.isfinite(x)) for x in numbers_in(result)):
                value = f"{name}={getattr(changed, name):g}"
                raise BrokenRule(f"{value} gives a result that is not finite: choose other bounds")


def _stacks(trial: EffectTrial) -> None:
    effects = [trial.effect.null(trial.choices), trial.start, *islice((e for _, e in trial.other_values()), 0, 6, 2)]
    for call in trial.calls:
        rank = max(x.ndim for x in numbers_in(call.arguments))
        stacked = trial.start.model_copy(
            update={
                name: np.array([getattr(effect, name) for effect in effects]).reshape(-1, *(1,) * rank)
                for name in trial.effect.parameters()
            }
        )
        _compare_stack(call, stacked, effects, rank)


def _compare_stack(call: Call, stacked: Effect, effects: Sequence[Effect], rank: int) -> None:
    with np.errstate(all="ignore"):
        together = numbers_in(stacked.apply(*frozen(call.arguments)))
        alone = [numbers_in(effect.apply(*frozen(call.arguments))) for effect in effects]
    for k, numbers in enumerate(alone):
        for several, one in zip(together, numbers, strict=True):
            wide = np.broadcast_to(several, np.broadcast_shapes(several.shape, (len(effects), *(1,) * rank)))
            if not np.allclose(wide[k], one, rtol=SAME, atol=1e-12, equal_nan=True):
                raise BrokenRule(
                    "several robots at once, with arrays in the parameters, give other results than one: compute with "
                    "NumPy, without if"
                )


def _rows(trial: EffectTrial) -> None:
    for call in trial.calls:
        first = call.arguments[0]
        if not isinstance(first, np.ndarray) or first.ndim < 2 or len(first) < 2:
            continue
        for row in (0, len(first) - 1):
            for whole, one in _pairs(call.result, trial.start.apply(*frozen(rows_of(call.arguments, row)))):
                if not np.allclose(whole[row], one[0], rtol=SAME, atol=1e-12, equal_nan=True):
                    raise BrokenRule(
                        "one row alone gives another result than among all rows: use no sum or mean over rows"
                    )


def _acts(trial: EffectTrial) -> None:
    silent = dict.fromkeys(trial.effect.parameters())
    for place in ("bench", "floor", "twin"):
        for name, changed in trial.other_values() if place in trial.places() else ():
            cannot_drive = place == "twin" and list(changed.faults(in_simulation=True))
            if name in silent and not cannot_drive and not equal(trial.read(place, changed), trial.at_start[place]):
                del silent[name]
    if silent:
        raise BrokenRule(
            f"{', '.join(silent)}: no value changes a reading, with the other numbers at their start: use it in apply, "
            "or remove it"
        )


def _steps(trial: EffectTrial) -> None:
    if "twin" not in trial.places():
        return
    probe, null = trial.probe, trial.effect.null(trial.choices)
    whole, half = (
        probe.path(trial.robot(trial.start), parts) - probe.path(trial.robot(null), parts) for parts in (1, 2)
    )
    largest = max(np.abs(whole).max(), np.abs(half).max())
    if np.abs(whole - half).max() > OF_STEPS * largest:
        share = 100 * np.abs(whole - half).max() / largest
        raise BrokenRule(
            f"with time steps of half the length, its effect on the path differs by {share:.0f} %: apply uses the size "
            "of a turn or a duration, which is that of one step; use a speed, or divide by the step"
        )


def _distinct(trial: EffectTrial) -> None:
    rival = closest(trial)
    if rival is not None and rival.share > SAME_SHARE:
        raise BrokenRule(f"{rival.name} has the same effect on all readings; use that one")


RULES: tuple[Rule[EffectTrial], ...] = (
    Rule(
        "texts", "cause and excitation state in words where it comes from and what shows it; setups is stated", _texts
    ),
    Rule("bounds", "bounds are finite, in order, and hold null and start", _bounds),
    Rule("units", "every number has a unit, which its name ends with", _units),
    Rule("settings", "a robot file takes values up to the bounds and refuses others; JSON reads back equal", _settings),
    Rule("form", "apply returns its first argument, changed, with the same type and shape", _form),
    Rule("null", "at its null values it changes no bit, in PyBullet, in the twin and on the benches", _null),
    Rule("start", "at its start values it changes a reading", _start),
    Rule("pure", "the same arguments give the same result, and apply changes none of them", _pure),
    Rule("repeats", "the same experiment gives the same bytes", _repeats),
    Rule("finite", "results are finite for all values up to the bounds", _finite),
    Rule("rows", "one row of an array alone gives the same result as among all rows", _rows),
    Rule("stacks", "many robots at once, as in a fit, give the same results as each alone", _stacks),
    Rule("acts", "each number changes a reading", _acts),
    Rule("steps", "with time steps of half the length, its effect on the motion is the same", _steps),
    Rule("distinct", "no shipped effect of its slot does the same to all readings", _distinct),
)
"""All rules, in the order in which they are reported."""
