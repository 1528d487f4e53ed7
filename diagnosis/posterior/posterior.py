"""posterior.yaml: the hypotheses that the data leave, each with the joint distribution of the robot's numbers.

The weight of a hypothesis is its Akaike weight, as for the confidence in a name (`inference/rivals.py`).
"""

import json
from collections.abc import Iterator, Mapping
from math import exp
from typing import Any

import numpy as np

from configs.effects.registry import EFFECTS
from configs.posterior.schema import FILE, VERSION, Posterior
from configs.schema.robot import RobotConfig
from configs.user_files import EFFECT_FILES
from diagnosis.diagnose import Diagnosis
from diagnosis.extended_robot import (
    RECORDED,
    difference_of,
    enclosing,
    leaf_paths,
    plain_tree,
    recorded_ranges,
    rounded,
    simulated,
)
from diagnosis.inference.fitting.fit import HypothesisFit
from diagnosis.inference.naming.seen_range import conditions, predicted_readings, seen_ranges
from diagnosis.inference.naming.verdict import CaseVerdict
from diagnosis.inference.selection.rivals import AS_GOOD, SOMETHING_ELSE, relative_weight
from diagnosis.posterior.random_slip import RandomSlipEstimate, random_slip
from diagnosis.posterior.robot_numbers import RobotNumbers, robot_numbers
from diagnosis.predictors.pose.by_counts import Pose
from symolo.core.arrays import Array
from symolo.core.yaml.tree import FieldPath, dotted

__all__ = ["FILE", "posterior", "posterior_text"]

DIGITS = 10
"""Digits of a number in the file."""
WIDEST_SD = 3.0
"""Standard deviations of the wheel separation that the chassis covers."""
NO_EFFECT = "no effect"
SPEED = "wheel_speed_rad_s"
"""Name of the speed of a wheel in a run."""
_NOT_SET = ("name", "description", "effect_ranges", "effect_files")
"""Fields of the robot that do not describe what was measured."""


def weighted_fits(diagnosis: Diagnosis) -> tuple[list[HypothesisFit], Array]:
    """Return the fits of all hypotheses that remain, the named one first, and their probabilities (H,)."""
    weights = np.array([1.0, *(relative_weight(max(each.worse, 0.0)) for each in diagnosis.alternatives)])
    return [diagnosis.fit, *(each.fit for each in diagnosis.alternatives)], weights / weights.sum()


def posterior(diagnosis: Diagnosis) -> Posterior:
    """Return the posterior of a diagnosis."""
    return Posterior.model_validate(_content(diagnosis))


def posterior_text(diagnosis: Diagnosis) -> str:
    """Return the content of posterior.yaml."""
    content = _content(diagnosis)
    Posterior.model_validate(content)
    if "effect_files" in content:  # the file names them, and they lie beside it
        content["effect_files"] = [record["file"] for record in content["effect_files"]]
    head = [
        f"# The robots that agree with {content['source']}. `symolo release SCENARIO --like` draws from them: first a",
        "# hypothesis by its weight, then its numbers together. A number, or its logarithm if its scale is log, has a",
        "# normal distribution with this mean, cut off at its bounds. FF' is the covariance of all, with the factor F.",
    ]
    return "\n".join([*head, *_lines(content, 0)]) + "\n"


def _content(diagnosis: Diagnosis) -> dict[str, Any]:
    fits, shares = weighted_fits(diagnosis)
    order = np.argsort(-shares, kind="stable").tolist()
    slip = random_slip(diagnosis)
    measurement, structure = diagnosis.measurement, diagnosis.unexplained
    content: dict[str, Any] = {
        "version": VERSION,
        "source": f"{measurement.name} ({measurement.kind})"[:200],
        "robot": diagnosis.base_robot.name,
        "something_else": _short(_something_else(diagnosis)),
        "unexplained": f"{structure.channel} over {structure.covariate}" if structure else "",
        "hypotheses": [_hypothesis(diagnosis, fits[k], float(shares[k]), slip) for k in order],
        "measured": list(_measured(diagnosis)),
        "noise": list(_noise(diagnosis)),
    }
    used = {field["field"].split(".")[1] for each in content["hypotheses"] for field in _effect_fields(each)}
    if files := [EFFECT_FILES.record_of(name) for name in sorted(used & EFFECTS.files.keys())]:
        content["effect_files"] = files
    return content


def _something_else(diagnosis: Diagnosis) -> float:
    """Return the probability that none of the hypotheses is right: all that the confidence in a name counts, except the
    rivals which are hypotheses themselves; of several names, that of the least certain one.
    """
    if not diagnosis.named:
        is_refuted = diagnosis.conclusion is CaseVerdict.UNEXPLAINED
        return 1.0 if is_refuted else SOMETHING_ELSE / (1.0 + SOMETHING_ELSE)
    listed = []
    for comparison in (named.comparison for named in diagnosis.named):
        rises = [max(rival.worse, 0.0) for rival in comparison.rivals if rival.worse < AS_GOOD]
        listed.append(comparison.confidence * (1.0 + sum(map(relative_weight, rises))))
    return max(0.0, 1.0 - min(listed))


def _effect_fields(hypothesis: Mapping[str, Any]) -> Iterator[Mapping[str, Any]]:
    fields = (*hypothesis["fixed"], *hypothesis["numbers"])
    yield from (each for each in fields if each["field"].startswith("effects."))


def _hypothesis(
    diagnosis: Diagnosis, fit: HypothesisFit, weight: float, slip: RandomSlipEstimate | None
) -> dict[str, Any]:
    """Return one hypothesis as plain data."""
    is_named = fit is diagnosis.fit
    config, left_out, _ = simulated(diagnosis.extended if is_named else fit.robot, fit.hypothesis.effects)
    config, _ = rounded(config, diagnosis.nominal)
    numbers = robot_numbers(fit, config)
    config = _with_room(config, numbers)
    if slip is not None:
        numbers = slip.beside(numbers)
    effects = [effect.name for effect in fit.hypothesis.effects]
    if is_named and diagnosis.random_drift is not None:
        effects.append(diagnosis.random_drift.effect.name)
    base_robot, drawn = plain_tree(diagnosis.base_robot), {number.path for number in numbers.numbers}
    return {
        "name": " and ".join(effects)[:200] or NO_EFFECT,
        "weight": _short(weight),
        "left_out": [effect.name for effect in left_out],
        "not_determined": [dotted(path) for path in numbers.not_determined],
        "fixed": list(_fixed(plain_tree(config), base_robot, drawn)),
        "numbers": [
            {
                "field": dotted(number.path),
                "unit": number.unit,
                "scale": "log" if number.is_log else "linear",
                "mean": _short(number.mean),
                "low": number.low,
                "high": number.high,
                "replaces": _value_at(base_robot, number.path),
            }
            for number in numbers.numbers
        ],
        "factor": [[_short(value) for value in row[: k + 1]] for k, row in enumerate(numbers.factor.tolist())],
        "effect_ranges": [each.model_dump(mode="json") for each in _ranges(diagnosis, fit, config)],
    }


def _with_room(config: RobotConfig, numbers: RobotNumbers) -> RobotConfig:
    """Return the robot with a chassis that covers the wheels of nearly all drawn robots."""
    for number, sd in zip(numbers.numbers, numbers.sd.tolist(), strict=True):
        if number.path == ("drive", "track_m"):
            reach = WIDEST_SD * sd
            track_m = exp(number.mean + reach) if number.is_log else number.mean + reach
            width_m = enclosing(config.with_section("drive", {"track_m": track_m})).chassis.width_m
            return config.with_section("chassis", {"width_m": width_m})
    return config


def _fixed(tree: Mapping[str, Any], base_robot: Mapping[str, Any], drawn: set[FieldPath]) -> Iterator[dict[str, Any]]:
    """Yield the fields that differ from the robot that the diagnosis extends and are not drawn."""
    difference = {key: value for key, value in difference_of(tree, base_robot).items() if key not in _NOT_SET}
    for path in leaf_paths(difference):
        value = _value_at(difference, path)
        if path not in drawn and (value is None or isinstance(value, (bool, int, float, str))):
            before = _value_at(base_robot, path)
            scalar = before if isinstance(before, (bool, int, float, str)) else None
            yield {"field": dotted(path), "value": value, "replaces": scalar}


def _value_at(tree: Mapping[str, Any], path: FieldPath) -> Any:  # noqa: ANN401 - whatever a robot has
    value: Any = tree
    for key in path:
        value = value.get(str(key)) if isinstance(value, Mapping) else None
    return value


def _ranges(diagnosis: Diagnosis, fit: HypothesisFit, config: RobotConfig) -> Iterator[Any]:
    """Yield the ranges in which the effects of a hypothesis were seen, of those quantities that a run records."""
    known = {named.effect.name: named.ranges for named in diagnosis.named} if fit is diagnosis.fit else {}
    for effect in fit.hypothesis.effects:
        if config.effects.get(effect.kind) is None:
            continue
        ranges = known.get(effect.name) or seen_ranges(diagnosis.evidence, diagnosis.selection.nominal, fit, effect)
        yield from recorded_ranges(effect.kind.name, ranges)


def _measured(diagnosis: Diagnosis) -> Iterator[dict[str, Any]]:
    """Yield the range of each covariate over all samples that were used."""
    evidence, ranges = diagnosis.measured, dict[str, tuple[float, float]]()
    usable, readings = evidence.fit | evidence.heldout, predicted_readings(evidence, diagnosis.fit)
    for observed, place in zip(evidence.observed, evidence.places, strict=True):
        for name, values in conditions(observed, readings):
            inside = values[usable[place] & np.isfinite(values)]
            if len(inside):
                low, high = ranges.get(name, (np.inf, -np.inf))
                ranges[name] = (min(low, float(inside.min())), max(high, float(inside.max())))
    if SPEED not in map(RECORDED.get, ranges):
        ranges |= _speeds_by_counts(diagnosis)
    for name, (low, high) in ranges.items():
        yield {
            "covariate": name,
            "quantity": RECORDED.get(name, SPEED if name == SPEED else None),
            "low": _short(low),
            "high": _short(high),
        }


def _speeds_by_counts(diagnosis: Diagnosis) -> dict[str, tuple[float, float]]:
    """Return the range of the wheel speeds in a log with counts; nothing without counts.

    Without voltages no speed is predicted, so that none is a covariate.
    """
    evidence = diagnosis.measured
    usable = evidence.fit | evidence.heldout
    for stage in evidence.stages:
        if isinstance(stage, Pose) and stage.has_wheels:
            first = next(k for k, observed in enumerate(evidence.observed) if observed is stage.observed[0])
            speeds = stage.wheel_speeds_rad_s(diagnosis.nominal)[usable[evidence.places[first]]]
            if len(speeds):
                return {SPEED: (float(speeds.min()), float(speeds.max()))}
    return {}


def _noise(diagnosis: Diagnosis) -> Iterator[dict[str, Any]]:
    """Yield the scatter of each observed quantity about the fit."""
    evidence, fit = diagnosis.evidence, diagnosis.fit
    usable = evidence.fit | evidence.heldout
    for k, (observed, place) in enumerate(zip(evidence.observed, evidence.places, strict=True)):
        rows = usable[place]
        if rows.any():
            yield {
                "channel": observed.name,
                "unit": observed.unit,
                "sd": _short(float(np.median(fit.sd[place][rows]))),
                "level": _short(float(fit.noise.levels[k])),
                "outliers": _short(float(fit.noise.shares[k])),
            }


def _short(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def _lines(content: Mapping[str, Any], depth: int) -> Iterator[str]:
    """Yield YAML in which lists of mappings and of numbers have an item in each line."""
    indent = "  " * depth
    for key, value in content.items():
        if not (isinstance(value, list) and value):
            yield f"{indent}{key}: {_flow(value)}"
            continue
        yield f"{indent}{key}:"
        for item in value:
            if key == "hypotheses":
                first, *rest = _lines(item, depth + 2)
                yield f"{indent}  - {first.lstrip()}"
                yield from rest
            else:
                yield f"{indent}  - {_flow(item)}"


def _flow(value: object) -> str:
    return json.dumps(value, ensure_ascii=False)
