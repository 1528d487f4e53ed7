"""Robots from the posterior of a diagnosis: first a hypothesis by its weight, then its numbers together.

The numbers are normal deviates of a random stream, multiplied by the factor of the covariance. A robot with a number
outside its bounds, or which is impossible as a whole, is drawn again from the same stream, so that the distribution is
cut off and the same seed gives the same robot.
"""

import math
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from statistics import NormalDist
from typing import Any

import numpy as np

from configs.checks.robot import robot_faults
from configs.posterior.schema import FittedNumber, Posterior, RobotHypothesis, path_of
from configs.schema.robot import RobotConfig
from configs.validation.values import filled
from symolo.core.errors import InputError
from symolo.core.yaml.tree import FieldPath, Node, Scalar, Values, merge, node_of

MAX_ATTEMPTS = 10_000
"""Number of draws after which a robot within all bounds is taken for impossible."""
KEY = "like"
HYPOTHESIS = f"{KEY}.hypothesis"
NUMBERS = f"{KEY}.numbers"
"""Keys of the random streams of the hypothesis and of its numbers."""


@dataclass(frozen=True)
class DrawnRobot:
    """One robot of the posterior."""

    hypothesis: RobotHypothesis
    numbers: Mapping[str, float]
    """Drawn numbers by their field below `robot`."""

    def on(self, root: Node) -> Node:
        """Return the tree of a scenario with this robot."""
        return with_robot(root, self.hypothesis, self.numbers)


def drawn_hypothesis(posterior: Posterior, rng: np.random.Generator) -> RobotHypothesis:
    """Return a hypothesis, each as likely as its weight."""
    share = rng.random() * math.fsum(each.weight for each in posterior.hypotheses)
    for hypothesis in posterior.hypotheses:
        share -= hypothesis.weight
        if share < 0.0:
            return hypothesis
    return posterior.hypotheses[-1]


def drawn_robot(
    root: Node, hypothesis: RobotHypothesis, values: Values, rng: np.random.Generator, where: str = ""
) -> DrawnRobot:
    """Return a robot of a hypothesis.

    Args:
        root: Tree of the scenario.
        hypothesis: The hypothesis.
        values: Values in place of the distributions of the scenario.
        rng: Random stream.
        where: Place of the posterior, for an error.

    Raises:
        InputError: Nearly all robots of the hypothesis are impossible.
    """
    problem = ""
    for _ in range(MAX_ATTEMPTS):
        numbers = _drawn_numbers(hypothesis, rng)
        outside = next((each for each in hypothesis.numbers if not each.low <= numbers[each.field] <= each.high), None)
        if outside is not None:
            problem = f"{outside.field} outside {outside.low:g} to {outside.high:g}"
            continue
        robot = DrawnRobot(hypothesis, numbers)
        problem = next(_problems(robot.on(root), values), "")
        if not problem:
            return robot
    what = f"{KEY}: {MAX_ATTEMPTS} robots of {hypothesis.name} were drawn, and all are impossible; the last: {problem}"
    raise InputError(what, where=where, cure="measure the robot better, or use its extended.yaml in its place")


def mean_robot(hypothesis: RobotHypothesis) -> DrawnRobot:
    """Return the robot in the middle of a hypothesis."""
    return DrawnRobot(hypothesis, {each.field: _value(each, each.mean) for each in hypothesis.numbers})


def with_robot(root: Node, hypothesis: RobotHypothesis, numbers: Mapping[str, float]) -> Node:
    """Return the tree of a scenario whose robot has the fields of a hypothesis and these numbers."""
    tree: dict[str, Any] = {}
    for field, value in (*((each.field, each.value) for each in hypothesis.fixed), *numbers.items()):
        section = tree
        *above, last = path_of(field)
        for key in above:
            section = section.setdefault(key, {})
        section[last] = value
    if hypothesis.effect_ranges:
        tree.setdefault("robot", {})["effect_ranges"] = [
            each.model_dump(mode="json") for each in hypothesis.effect_ranges
        ]
    return _with_files(merge(root, node_of(tree, root.place_of((KEY, "hypotheses")))))


def _with_files(root: Node) -> Node:
    """Return the tree with the files of those effects of the user's own that its robot has from the posterior."""
    robot, files = root.child("robot"), root.at((KEY, "effect_files"))
    effects = robot.child("effects") if robot else None
    present = {str(key) for key, node in effects.children() if node.value is not None} if effects else set()
    needed = [node for _, node in files.children() if node.plain_at(("name",)) in present] if files else []
    if not needed or robot is None or not isinstance(robot.value, dict) or not isinstance(root.value, dict):
        return root
    names = {node.plain_at(("name",)) for node in needed}
    others = [node for _, node in robot.value.get("effect_files", Node((), "")).children()]
    others = [node for node in others if node.plain_at(("name",)) not in names]
    all_files = Node((*others, *needed), needed[0].where)
    return Node({**root.value, "robot": Node({**robot.value, "effect_files": all_files}, robot.where)}, root.where)


def _drawn_numbers(hypothesis: RobotHypothesis, rng: np.random.Generator) -> dict[str, float]:
    columns = max((len(row) for row in hypothesis.factor), default=0)
    normal = NormalDist()
    # A quantile function and exact sums give the same bits with every version of NumPy and its linear algebra.
    deviates = [normal.inv_cdf(max(rng.random(), sys.float_info.min)) for _ in range(columns)]
    numbers: dict[str, float] = {}
    for number, row in zip(hypothesis.numbers, hypothesis.factor, strict=True):
        deviation = math.fsum(factor * deviate for factor, deviate in zip(row, deviates, strict=False))
        numbers[number.field] = _value(number, number.mean + deviation)
    return numbers


def _value(number: FittedNumber, coordinate: float) -> float:
    if number.scale == "linear":
        return coordinate
    try:
        return math.exp(coordinate)
    except OverflowError:
        return math.inf


def _problems(root: Node, values: Values) -> Iterator[str]:
    """Yield what is wrong with the robot of a scenario."""
    robot = root.child("robot")
    assert robot is not None  # noqa: S101 - the schema demands it
    config = RobotConfig.model_validate(filled(robot, _below(values, "robot")))
    for fault in robot_faults(config, in_simulation=True):
        yield ": ".join(filter(None, (".".join(map(str, fault.path)), fault.problem, fault.allowed)))


def _below(values: Values, key: str) -> dict[FieldPath, Scalar]:
    return {path[1:]: value for path, value in values.items() if path and path[0] == key}
