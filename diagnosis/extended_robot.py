"""The extended model as a robot file: what a diagnosis found, as keys that every simulation takes.

The file builds on the shipped robot `nominal` and contains only what differs: the case's parameters, the nuisances as
fitted, and the named effects, each number with its source and standard error in a comment. It reads back equal.

A second file draws the effects again in each run, within what the fit leaves open. A scenario draws every number
independently, while fitted numbers are correlated: a torque constant that is a little too high and a scale that is a
little too low predict the same. Hence the nuisances stay as fitted, and the spread of an effect's number is its
conditional spread for fixed nuisances, from the inverse of the effects' part of the information matrix (Bishop, Pattern
Recognition and Machine Learning, 2006, eq. 2.73): narrower than the standard error of the number alone, and as true to
the data.
"""

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import ceil, isfinite
from typing import Any

import numpy as np
from pydantic import ValidationError

from configs.checks import robot_faults
from configs.draw import draw_robot
from configs.loader import load_section
from configs.schema.robot import RobotConfig
from diagnosis.diagnose import Diagnosis
from diagnosis.inference.hypothesis import CandidateEffect
from diagnosis.nuisances import Nuisance
from symolo.core.yaml_tree import FieldPath

BASE = "nominal"
FILE, VARIED_FILE = "extended.yaml", "extended_varied.yaml"
DIGITS = 7
"""Of a number in the file: the seventh is far below any standard error."""
UNTOUCHED = 5e-3
"""Tolerances by which a fit without data may be off by rounding."""
REACH_SD = 3.0
"""Standard deviations up to which a varied number is drawn."""


@dataclass(frozen=True)
class LeftOut:
    """An effect that the engine cannot simulate, and why."""

    name: str
    why: str


@dataclass(frozen=True)
class ExtendedRobot:
    config: RobotConfig
    """What the file says, the effects that are left out missing."""
    text: str
    """Of extended.yaml."""
    varied_text: str
    """Of extended_varied.yaml, which stands beside it; empty where no number can be varied."""
    left_out: tuple[LeftOut, ...]
    problem: str
    """Why no simulation takes the robot even so, such as a motor that cannot turn; empty if one does."""


def extended_robot(diagnosis: Diagnosis) -> ExtendedRobot:
    """The extended model of a diagnosis as robot files."""
    config = _enclosing(_within_bounds(diagnosis))
    left_out: list[LeftOut] = []
    problem = ""
    for fault in robot_faults(config, in_simulation=True):
        why = ", ".join(part for part in (fault.problem, f"allowed: {fault.allowed}" if fault.allowed else "") if part)
        if fault.path[:2] == ("robot", "effects"):
            left_out.append(LeftOut(str(fault.path[2]), why))
        elif not problem:
            problem = ".".join(map(str, fault.path)) + f": {why}"
    for gone in left_out:
        config = config.model_copy(update={"effects": config.effects.without(gone.name)})
    measured = diagnosis.measurement
    told = f"{measured.name} ({measured.kind})"
    named = ", ".join(f.name for f in diagnosis.named) or "no effect"
    config = config.model_copy(
        update={"name": _slug(measured.name), "description": f"Fitted to {told}: {named} beside the nominal model"}
    )
    config, moved = _rounded(config, diagnosis.nominal)
    head = [
        f"# The robot that symolo diagnose fitted to {told}. What is not here is that of the shipped robot {BASE}.",
        "# Standard errors are those of each number with all others fitted anew.",
        *(f"# LEFT OUT, for no drive can simulate it: {gone.name} ({gone.why})" for gone in left_out),
        *([f"# NOT YET A ROBOT THAT DRIVES: {problem}"] if problem else []),
        f"extends: {BASE}",
    ]
    tree = _difference(config)
    comments = {path: "of the nominal model" for path in _paths(tree) if len(path) > 1} | _comments(diagnosis) | moved
    text = "\n".join([*head, *_lines(tree, comments)]) + "\n"
    return ExtendedRobot(config, text, _varied(diagnosis, config), tuple(left_out), problem)


def _within_bounds(diagnosis: Diagnosis) -> RobotConfig:
    """The fitted robot; a logarithm and back may leave a bound by a rounding."""
    config = diagnosis.extended
    for named in diagnosis.named:
        kind = named.effect.kind
        fitted = config.effects.get(kind)
        numbers = {name: min(max(float(getattr(fitted, name)), p.low), p.high) for name, p in kind.parameters().items()}
        config = config.with_effect(kind.model_validate({**numbers, **dict(named.effect.choices)}))
    return config


def _enclosing(config: RobotConfig) -> RobotConfig:
    """With a chassis that covers the wheels: a case tells their distance, and not how wide the body is."""
    needed_m = config.drive.track_m + config.drive.wheel_width_m
    if config.chassis.width_m >= needed_m:
        return config
    chassis = config.chassis.model_copy(update={"width_m": ceil(1e3 * needed_m) / 1e3})
    return config.model_copy(update={"chassis": chassis})


def _rounded(config: RobotConfig, nominal: RobotConfig) -> tuple[RobotConfig, dict[FieldPath, str]]:
    """With as many digits in what differs as any fit can hold, for people to read, and within the schema's bounds.

    Args:
        config: As fitted; a tolerance has no bounds, so that friction may have come out below zero.
        nominal: Whose number stands in for one that has no nearest value within its bounds.

    Returns:
        The robot, and by field what was done to a number beyond its bounds.
    """

    def shortened(tree: Mapping[str, Any], differing: Mapping[str, Any]) -> dict[str, Any]:
        found = dict(tree)
        for key, value in differing.items():
            if isinstance(value, Mapping):
                found[key] = shortened(tree[key], value)
            elif isinstance(value, float):
                found[key] = float(f"{value:.{DIGITS}g}")
        return found

    tree = shortened(_tree(config), _difference(config))
    moved: dict[FieldPath, str] = {}
    try:
        return RobotConfig.model_validate(tree), moved
    except ValidationError as error:
        for fault in error.errors():
            section, own = tree, _tree(nominal)
            *above, last = map(str, fault["loc"])
            for key in above:
                section, own = section[key], own[key]
            if fault["type"] == "int_type":
                moved[*above, last] = f"the whole number next to {section[last]:g}"
                section[last] = round(section[last])
                continue
            limits = fault.get("ctx", {})
            moved[*above, last] = f"moved within its bounds; the fit asks for {section[last]:.3g}"
            section[last] = float(limits.get("ge", limits.get("le", own[last])))
    return RobotConfig.model_validate(tree), moved


def _tree(config: RobotConfig) -> dict[str, Any]:
    """Counts of a turn may be no whole number in a nominal robot, which is no fault of the file's."""
    return config.model_dump(mode="json", warnings=False)


def _slug(name: str) -> str:
    found = re.sub(r"[^A-Za-z0-9_-]+", "_", name).strip("_-")[:64]
    return found or "measured"


def _difference(config: RobotConfig) -> dict[str, Any]:
    base, _ = draw_robot(load_section("robot", BASE), 0, "diagnosis")
    return _differing(_tree(config), _tree(base))


def _differing(found: Mapping[str, Any], base: Mapping[str, Any]) -> dict[str, Any]:
    """Keys of `found` that `base` has not, or has with other values; keys of the base alone become null."""
    kept: dict[str, Any] = {}
    for key, value in found.items():
        other = base.get(key)
        if isinstance(value, Mapping) and isinstance(other, Mapping):
            if inner := _differing(value, other):
                kept[key] = inner
        elif key not in base or value != other:
            kept[key] = value
    return kept | {key: None for key in base if key not in found}


def _comments(diagnosis: Diagnosis) -> dict[FieldPath, str]:
    """By field path: where a number comes from, and how far it is known."""
    hypothesis, fit = diagnosis.fit.hypothesis, diagnosis.fit
    errors = np.sqrt(np.diag(fit.covariance)).tolist()
    found: dict[FieldPath, str] = {}
    bare = hypothesis.nominal
    for k, nuisance in enumerate(hypothesis.nuisances):
        at = nuisance.value + 3.0 * nuisance.tolerance
        moved = _differing(_tree(nuisance.applied(bare, at)), _tree(bare))
        told = _nuisance_told(nuisance, float(fit.x[k]), errors[k])
        found |= {path: told if path[-1] == nuisance.name else f"{nuisance.name}: {told}" for path in _paths(moved)}
    for named in diagnosis.named:
        for name in named.effect.kind.parameters():
            error = named.std[name]
            known = f"standard error {error:.2g}" if isfinite(error) and error > 0.0 else "not held by these data"
            found["effects", named.effect.kind.name, name] = f"named by the diagnosis; {known}"
        for name, _ in named.effect.choices:
            found["effects", named.effect.kind.name, name] = "named by the diagnosis"
    found["chassis", "width_m"] = "widened to cover the wheels"
    return found


def _nuisance_told(nuisance: Nuisance, off: float, error: float) -> str:
    """Its prior and what was fitted; offset and standard error in tolerances."""
    prior = f"nominal {nuisance.value:g}, tolerance {nuisance.tolerance:g}"
    if error > 1.0 - UNTOUCHED and abs(off) < UNTOUCHED:
        return f"{prior}; held by its tolerance alone"
    return f"{prior}; fitted {off:+.2f} tolerances off, standard error {error * nuisance.tolerance:.2g}"


def _paths(tree: Mapping[str, Any], above: FieldPath = ()) -> Iterator[FieldPath]:
    for key, value in tree.items():
        if isinstance(value, Mapping):
            yield from _paths(value, (*above, key))
        else:
            yield (*above, key)


def _lines(tree: Mapping[str, Any], comments: Mapping[FieldPath, str], above: FieldPath = ()) -> Iterator[str]:
    """YAML, two spaces a level, a comment after each leaf that has one."""
    for key, value in tree.items():
        path = (*above, key)
        indent = "  " * len(above)
        if isinstance(value, Mapping) and value:
            yield f"{indent}{key}:"
            yield from _lines(value, comments, path)
        else:
            comment = f"  # {comments[path]}" if path in comments else ""
            yield f"{indent}{key}: {json.dumps(value, ensure_ascii=False)}{comment}"


def _varied(diagnosis: Diagnosis, config: RobotConfig) -> str:
    """Of each number of an effect that is left, a Gaussian about its value."""
    effects: dict[str, Any] = {}
    for effect, spreads in _spreads(diagnosis):
        section = config.effects.get(effect.kind)
        if section is None:
            continue
        numbers: dict[str, Any] = {}
        for (name, bounds), sd in zip(effect.kind.parameters().items(), spreads, strict=True):
            mean = float(getattr(section, name))
            if isfinite(sd) and sd > 0.0:
                low, high = max(mean - REACH_SD * sd, bounds.low), min(mean + REACH_SD * sd, bounds.high)
                normal = {"mean": mean, "sd": sd, "low": low, "high": high}
                numbers[name] = {"normal": {key: float(f"{value:.{DIGITS}g}") for key, value in normal.items()}}
        if numbers:
            effects[effect.kind.name] = numbers
    if not effects:
        return ""
    head = [
        f"# {FILE} beside this file, its effects drawn again in each run as far as the fit leaves them open, with all",
        f"# nominal parameters held as fitted. Limits lie at {REACH_SD:g} standard deviations, or at the bounds.",
        f"extends: {FILE}",
        f"name: {json.dumps(_slug(config.name[:57] + '_varied'))}",
    ]
    return "\n".join([*head, *_lines({"effects": effects}, {})]) + "\n"


def _spreads(diagnosis: Diagnosis) -> Iterator[tuple[CandidateEffect, Sequence[float]]]:
    """Standard deviation of each number of each effect, the nuisances held."""
    fit, hypothesis = diagnosis.fit, diagnosis.fit.hypothesis
    first = len(hypothesis.nuisances)
    variance = np.diag(np.linalg.pinv(fit.information[first:, first:], rcond=1e-12, hermitian=True))
    for effect in hypothesis.effects:
        at = hypothesis.parameters(effect)
        sd = np.sqrt(np.maximum(variance[at.start - first : at.stop - first], 0.0)).tolist()
        x = fit.x[at].tolist()
        yield effect, [abs(c.slope(v)) * s for c, v, s in zip(effect.coordinates, x, sd, strict=True)]
