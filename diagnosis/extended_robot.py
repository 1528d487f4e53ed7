"""The extended model as a robot file, with keys that every simulation accepts.

The file extends the shipped robot `nominal` and contains only differences: the parameters of the case, the fitted
nuisances and the named effects, each number with its source and standard error in a comment. It reads back equal.
"""

import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import ceil, isfinite
from typing import Any

import numpy as np
from pydantic import ValidationError

from configs.checks.robot import robot_faults
from configs.effects.base import Effect
from configs.effects.registry import EFFECTS
from configs.loader import NOMINAL_ROBOT as BASE
from configs.loader import shipped_robot
from configs.schema.code_file import CodeFile
from configs.schema.effect_range import EffectRange
from configs.schema.robot import RobotConfig
from configs.user_files import EFFECT_FILES
from diagnosis.diagnose import Diagnosis
from diagnosis.inference.fitting.hypothesis import CandidateEffect
from diagnosis.inference.naming.named_effect import NamedEffect
from diagnosis.inference.naming.seen_range import SeenRange
from diagnosis.nominal_robot import PLAIN_RANGE
from diagnosis.nuisances import Nuisance
from symolo.core.yaml.tree import FieldPath

FILE = "extended.yaml"
DIGITS = 7
"""Digits of a number in the file; the last is far below any standard error."""
UNTOUCHED = 5e-3
"""Deviation in tolerances that may be rounding error of a parameter without data."""
ONE_RAY = "the case has one ray along the axis; without this line, the sensor is that of the shipped robot"
"""Comment on the cone and the error that the range sensor of a case lacks."""
RECORDED = {
    "v_m_s": "v_m_s",
    "w_rad_s": "w_rad_s",
    "omega_rad_s": "wheel_speed_rad_s",
    "u_V": "voltage_V",
    "u_cmd_V": "voltage_V",
    "current_A": "current_A",
    "distance_m": "tof_m",
}
"""Quantity of a run by the covariate of an effect. A run is not warned about the others."""


@dataclass(frozen=True)
class LeftOut:
    """An effect that the engine cannot simulate, and why."""

    name: str
    why: str


@dataclass(frozen=True)
class ExtendedRobot:
    """The fitted robot and its file."""

    config: RobotConfig
    """Robot of the file, without the effects that are left out."""
    text: str
    """Content of extended.yaml."""
    left_out: tuple[LeftOut, ...]
    problem: str
    """Why no simulation accepts the robot, such as a motor that cannot turn; empty if one does."""


@dataclass(frozen=True)
class BesideFit:
    """An effect of the robot that is estimated beside the fit, because it moves no prediction."""

    effect: Effect
    comments: Mapping[str, str]
    """Source of each number."""


def extended_robot(diagnosis: Diagnosis, beside: Sequence[BesideFit] = ()) -> ExtendedRobot:
    """Return the extended model of a diagnosis as a robot file.

    Args:
        diagnosis: The diagnosis.
        beside: Effects that the robot has in addition to those of the fit.
    """
    config = diagnosis.extended
    for each in beside:
        config = config.with_effect(each.effect)
    config, left_out, problem = simulated(config, [each.effect for each in diagnosis.fitted_effects])
    measured = diagnosis.measurement
    source = f"{measured.name} ({measured.kind})"
    named = ", ".join(name.partition("[")[0] for name in diagnosis.names) or "no effect"
    named += f" and the law {diagnosis.law.name}" if diagnosis.law else ""
    config = config.model_copy(
        update={"name": _slug(measured.name), "description": f"Fitted to {source}: the nominal model with {named}"}
    )
    config, moved = rounded(config, diagnosis.nominal)
    config = config.model_copy(
        update={"effect_ranges": tuple(_ranges(diagnosis, config)), "effect_files": tuple(_own_files(config))}
    )
    head = [
        f"# The robot that symolo diagnose fitted to {source}. Everything else is as in the shipped robot {BASE}.",
        "# Standard errors are those of a number with all other numbers fitted too.",
        *(f"# LEFT OUT, since no drive can simulate it: {effect.name} ({effect.why})" for effect in left_out),
        *([f"# THIS ROBOT CANNOT DRIVE YET: {problem}"] if problem else []),
        f"extends: {BASE}",
    ]
    tree = _difference(config)
    if config.effect_files:  # the file names them, and they lie beside it
        tree["effect_files"] = [file.file for file in config.effect_files]
    if config.sensor_files:
        tree["sensor_files"] = [file.file for file in config.sensor_files]
    comments = {path: "of the nominal model" for path in leaf_paths(tree) if len(path) > 1} | _comments(diagnosis)
    for each in beside:
        comments |= {("effects", each.effect.name, name): text for name, text in each.comments.items()}
    comments |= moved
    text = "\n".join([*head, *_lines(tree, comments)]) + "\n"
    return ExtendedRobot(config, text, left_out, problem)


def simulated(config: RobotConfig, effects: Sequence[CandidateEffect]) -> tuple[RobotConfig, tuple[LeftOut, ...], str]:
    """Return a fitted robot as a drive can simulate it, the effects that this leaves out, and why no drive can.

    Args:
        config: The fitted robot.
        effects: Those of its effects that were fitted.
    """
    config = enclosing(_within_bounds(config, effects))
    left_out: list[LeftOut] = []
    problem = ""
    for fault in robot_faults(config, in_simulation=True):
        why = ", ".join(part for part in (fault.problem, f"allowed: {fault.allowed}" if fault.allowed else "") if part)
        if fault.path[:2] == ("robot", "effects"):
            left_out.append(LeftOut(str(fault.path[2]), why))
        elif not problem:
            problem = ".".join(map(str, fault.path)) + f": {why}"
    for effect in left_out:
        config = config.model_copy(update={"effects": config.effects.without(effect.name)})
    return config, tuple(left_out), problem


def _ranges(diagnosis: Diagnosis, config: RobotConfig) -> Iterator[EffectRange]:
    """Yield the ranges in which the effects of the robot were seen, of those quantities that a run records."""
    for named in diagnosis.fitted_effects:
        if config.effects.get(named.effect.kind) is not None:
            yield from recorded_ranges(named.name, named.ranges)


def recorded_ranges(effect: str, ranges: Iterable[SeenRange]) -> Iterator[EffectRange]:
    """Yield those of the ranges in which an effect was seen whose quantities a run records."""
    for seen in ranges:
        if (quantity := RECORDED.get(seen.covariate)) is not None:
            low, high = (float(f"{value:.4g}") for value in (seen.low, seen.high))
            yield EffectRange.model_validate({"effect": effect, "quantity": quantity, "low": low, "high": high})


def _own_files(config: RobotConfig) -> Iterator[CodeFile]:
    """Yield the files of those effects of the robot that are the user's own."""
    for effect in config.effects:
        if effect.name in EFFECTS.files:
            yield CodeFile.model_validate(EFFECT_FILES.record_of(effect.name))


def _within_bounds(config: RobotConfig, effects: Sequence[CandidateEffect]) -> RobotConfig:
    """Return the fitted robot within the bounds, which the rounding of a logarithm and back may exceed."""
    for effect in effects:
        kind = effect.kind
        fitted = config.effects.get(kind)
        numbers = {name: min(max(float(getattr(fitted, name)), p.low), p.high) for name, p in kind.parameters().items()}
        config = config.with_effect(kind.model_validate({**numbers, **dict(effect.choices)}))
    return config


def enclosing(config: RobotConfig) -> RobotConfig:
    """Return the robot with a chassis that covers the wheels; a case does not state the width of the body."""
    needed_m = config.drive.track_m + config.drive.wheel_width_m
    if config.chassis.width_m >= needed_m:
        return config
    return config.with_section("chassis", {"width_m": ceil(1e3 * needed_m) / 1e3})


def rounded(config: RobotConfig, nominal: RobotConfig) -> tuple[RobotConfig, dict[FieldPath, str]]:
    """Return the robot with rounded differences within the bounds of the schema.

    Args:
        config: The fitted robot; a nuisance has no bounds, so friction may be below zero.
        nominal: The robot whose number is used if there is no nearest value within the bounds.

    Returns:
        The robot, and a comment by field for each number that was outside its bounds.
    """
    tree, nominal_tree = plain_tree(config), plain_tree(nominal)
    for path in leaf_paths(_difference(config)):
        section, name = _section(tree, path), str(path[-1])
        if isinstance(value := section.get(name), float):
            section[name] = float(f"{value:.{DIGITS}g}")
    moved: dict[FieldPath, str] = {}
    try:
        return RobotConfig.model_validate(tree), moved
    except ValidationError as error:
        for fault in error.errors():
            path = tuple(map(str, fault["loc"]))
            section, name = _section(tree, path), path[-1]
            if fault["type"] == "int_type":
                moved[path] = f"the nearest integer to {section[name]:g}"
                section[name] = round(section[name])
                continue
            limits = fault.get("ctx", {})
            moved[path] = f"moved to its bound; the fitted value is {section[name]:.3g}"
            section[name] = float(limits.get("ge", limits.get("le", _section(nominal_tree, path)[name])))
    return RobotConfig.model_validate(tree), moved


def plain_tree(config: RobotConfig) -> dict[str, Any]:
    """Return a robot as plain data."""
    # The counts of a turn need not be an integer in a nominal robot, of which pydantic would warn.
    return config.model_dump(mode="json", warnings=False)


def _section(tree: dict[str, Any], path: FieldPath) -> dict[str, Any]:
    """Return the section that contains a field."""
    for key in path[:-1]:
        tree = tree[str(key)]
    return tree


def _slug(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9_-]+", "_", name).strip("_-")[:64] or "measured"


def _difference(config: RobotConfig) -> dict[str, Any]:
    return difference_of(plain_tree(config), plain_tree(shipped_robot()))


def difference_of(tree: Mapping[str, Any], base: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keys of `tree` that `base` lacks or has with other values; keys that only `base` has become null."""
    differing: dict[str, Any] = {}
    for key, value in tree.items():
        other = base.get(key)
        if isinstance(value, Mapping) and isinstance(other, Mapping):
            if inner := difference_of(value, other):
                differing[key] = inner
        elif key not in base or value != other:
            differing[key] = value
    return differing | {key: None for key in base if key not in tree}


def _comments(diagnosis: Diagnosis) -> dict[FieldPath, str]:
    """Return a comment by field path: where a number comes from, and its standard error."""
    hypothesis, fit = diagnosis.fit.hypothesis, diagnosis.fit
    errors = np.sqrt(np.diag(fit.covariance)).tolist()
    comments: dict[FieldPath, str] = {}
    bare = hypothesis.nominal
    for k, nuisance in enumerate(hypothesis.nuisances):
        # Of an effect, the robot has nothing at the nominal value, so the slope is that between two others.
        near, far = (nuisance.value + times * nuisance.tolerance for times in (1.5, 3.0))
        before, after = (plain_tree(nuisance.change_robot(bare, at)) for at in (near, far))
        for path in leaf_paths(difference_of(after, plain_tree(bare))):
            ends = [_section(tree, path)[str(path[-1])] for tree in (before, after)]
            slope = (ends[1] - ends[0]) / (far - near)
            text = _nuisance_text(nuisance, float(fit.x[k]), errors[k], slope)
            comments[path] = text if path[-1] == nuisance.name else f"{nuisance.name}: {text}"
    for named in diagnosis.fitted_effects:
        source = "law that the diagnosis discovered" if named is diagnosis.law else "named by the diagnosis"
        for name in named.values:
            error = named.std[name]
            known = f"standard error {error:.2g}" if isfinite(error) and error > 0.0 else "not determined by these data"
            seen = f"; seen for {named.seen_for}" if named.ranges else ""
            comments["effects", named.effect.kind.name, name] = f"{source}; {known}{seen}"
        for name in (*dict(named.effect.choices), *(named.known if isinstance(named, NamedEffect) else ())):
            comments["effects", named.effect.kind.name, name] = source
    if diagnosis.random_drift is not None:
        for name, error in diagnosis.random_drift.std.items():
            text = f"named by the diagnosis; standard error {error:.2g}"
            comments["effects", diagnosis.random_drift.effect.name, name] = text
    user_effects = "an effect of your own; a copy of the file that was loaded"
    comments["effect_files",] = "the law, and effects of your own if there are any" if diagnosis.law else user_effects
    if all(getattr(bare.tof, name) == value for name, value in PLAIN_RANGE.items()):
        # Without this, a simulation with the file would silently have a better sensor than the shipped robot.
        comments |= {("tof", name): ONE_RAY for name in PLAIN_RANGE}
    comments["chassis", "width_m"] = "widened to cover the wheels"
    comments["effect_ranges",] = "range of the data in which the effect was seen"
    return comments


def _nuisance_text(nuisance: Nuisance, off: float, error: float, slope: float) -> str:
    """Return prior and fitted value of a nuisance, and the standard error of the number that it sets.

    Args:
        nuisance: The nuisance.
        off: Deviation in tolerances.
        error: Standard error in tolerances.
        slope: Change of the number for a change of the nuisance by one.
    """
    prior = f"nominal {nuisance.value:g}, tolerance {nuisance.tolerance:g}"
    if error > 1.0 - UNTOUCHED and abs(off) < UNTOUCHED:
        return f"{prior}; determined by its tolerance only"
    return f"{prior}; fitted {off:+.2f} tolerances away, standard error {abs(slope) * error * nuisance.tolerance:.2g}"


def leaf_paths(tree: Mapping[str, Any], above: FieldPath = ()) -> Iterator[FieldPath]:
    for key, value in tree.items():
        if isinstance(value, Mapping):
            yield from leaf_paths(value, (*above, key))
        else:
            yield (*above, key)


def _lines(tree: Mapping[str, Any], comments: Mapping[FieldPath, str], above: FieldPath = ()) -> Iterator[str]:
    """Yield YAML with an indentation of two spaces, and a comment after each leaf that has one."""
    for key, value in tree.items():
        path = (*above, key)
        indent = "  " * len(above)
        if isinstance(value, Mapping) and value:
            yield f"{indent}{key}:"
            yield from _lines(value, comments, path)
            continue
        comment = f"  # {comments[path]}" if path in comments else ""
        if isinstance(value, list) and value:
            yield f"{indent}{key}:"
            yield from (f"{indent}  - {json.dumps(item, ensure_ascii=False)}{comment}" for item in value)
        else:
            yield f"{indent}{key}: {json.dumps(value, ensure_ascii=False)}{comment}"
