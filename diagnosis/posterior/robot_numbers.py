"""The numbers of a robot that a fit determines, with their joint covariance.

A fit has coordinates of its own: deviations of nominal parameters in tolerances, and the numbers of the effects. Two of
them may act on one field of the robot, such as the tolerance of a range offset and the effect of this name, and one may
act on a field by a factor, such as the radius of a wheel on its diameter. We therefore carry the covariance C of the
coordinates over to the fields: JCJ', where J has the derivatives of the fields, or of their logarithms, by the
coordinates. All of these functions are linear in the chosen coordinates, so that nothing is approximated.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import exp, log

import numpy as np

from configs.effects.registry import EFFECTS
from configs.schema.base import Section
from configs.schema.robot import RobotConfig
from configs.validation.shapes import Shape
from diagnosis.extended_robot import leaf_paths, plain_tree
from diagnosis.inference.fitting.coordinate import STEP
from diagnosis.inference.fitting.fit import NUISANCE_STEP, HypothesisFit
from diagnosis.inference.fitting.hypothesis import POSITIVE_TOLERANCES, Hypothesis
from diagnosis.measured.channel import Mask
from diagnosis.nuisances import UNITS
from symolo.core.arrays import Array
from symolo.core.yaml.tree import FieldPath

ROUNDING = 1e-9
"""Element of the factor relative to its row, below which it is a rounding error."""


@dataclass(frozen=True)
class RobotNumber:
    """One number of the robot in the coordinate in which it is nearly Gaussian."""

    path: FieldPath
    """Path in the robot."""
    unit: str
    is_log: bool
    """Whether the coordinate is the logarithm of the number."""
    mean: float
    """Fitted coordinate of the number."""
    low: float
    high: float
    """Bounds of the number."""

    @property
    def value(self) -> float:
        return exp(self.mean) if self.is_log else self.mean


@dataclass(frozen=True)
class RobotNumbers:
    """All numbers of the robot that a fit determines."""

    numbers: tuple[RobotNumber, ...]
    factor: Array
    """(F, K), lower triangular factor of their covariance, with non-negative diagonal; K is at most F."""
    not_determined: tuple[FieldPath, ...]
    """Numbers that the data do not determine, which keep their fitted value."""

    @property
    def sd(self) -> Array:
        """Return the standard deviations of the coordinates, (F,)."""
        return np.linalg.norm(self.factor, axis=1)


def robot_numbers(fit: HypothesisFit, config: RobotConfig) -> RobotNumbers:
    """Return the numbers that are uncertain after a fit.

    Args:
        fit: The fit.
        config: The fitted robot as a drive simulates it; numbers of other effects than its own are left out.
    """
    hypothesis, x = fit.hypothesis.of_robot(fit.x)
    is_of_robot = ~fit.hypothesis.is_local
    covariance = fit.covariance[np.ix_(is_of_robot, is_of_robot)].copy()
    open_ = ~np.isfinite(np.diag(covariance))
    covariance[open_], covariance[:, open_] = 0.0, 0.0
    fields, slopes = _derivatives(hypothesis, x)
    simulated = plain_tree(config)
    here = [path for path in fields if _at(simulated, path) is not None]
    rows = [fields[path] for path in here]
    values, logs = np.array([rows[k].value for k in range(len(here))]), np.zeros(len(here), dtype=bool)
    jacobian = np.zeros((len(here), len(x)))
    for k, path in enumerate(here):
        acting = slopes[path] != 0.0
        logs[k] = bool(values[k] > 0.0 and _is_log(hypothesis)[acting].all())
        jacobian[k] = slopes[path] / (values[k] if logs[k] else 1.0)
    uncertain = np.einsum("ij,jk,ik->i", jacobian, covariance, jacobian) > 0.0
    lost = [path for k, path in enumerate(here) if not uncertain[k] and (jacobian[k, open_] != 0.0).any()]
    chosen = np.flatnonzero(uncertain).tolist()
    numbers = tuple(_number(here[k], float(values[k]), is_log=bool(logs[k])) for k in chosen)
    return RobotNumbers(numbers, _triangular(jacobian[chosen] @ _root(covariance)), tuple(lost))


@dataclass(frozen=True)
class _Leaf:
    value: float


def _derivatives(hypothesis: Hypothesis, x: Array) -> tuple[dict[FieldPath, _Leaf], dict[FieldPath, Array]]:
    """Return the fields that the coordinates (P,) change, and their derivatives by the coordinates, (P,) each."""
    steps = np.full(len(x), STEP)
    steps[: len(hypothesis.nuisances)] = NUISANCE_STEP
    middle = _leaves(hypothesis.robot(x))
    slopes: dict[FieldPath, Array] = {}
    for k, step in enumerate(steps.tolist()):
        offset = step * np.eye(len(x))[k]
        above, below = _leaves(hypothesis.robot(x + offset)), _leaves(hypothesis.robot(x - offset))
        for path, value in middle.items():
            change = above[path] - below[path]
            if change != 0.0:
                # A number that a nuisance cannot make negative has a kink there; the outer side counts.
                is_kink = above[path] == value or below[path] == value
                slopes.setdefault(path, np.zeros(len(x)))[k] = change / (step if is_kink else 2.0 * step)
    return {path: _Leaf(middle[path]) for path in slopes}, slopes


def _leaves(robot: RobotConfig) -> dict[FieldPath, float]:
    """Return the numbers of a robot by their paths."""
    tree = plain_tree(robot)
    values = ((path, _at(tree, path)) for path in leaf_paths(tree))
    return {path: float(value) for path, value in values if isinstance(value, (int, float))}


def _at(tree: Mapping[str, object], path: FieldPath) -> object:
    value: object = tree
    for key in path:
        value = value.get(str(key)) if isinstance(value, Mapping) else None
    return value


def _is_log(hypothesis: Hypothesis) -> Mask:
    """Return which coordinates (P,) are logarithms."""
    nuisances = [nuisance.value > POSITIVE_TOLERANCES * nuisance.tolerance for nuisance in hypothesis.nuisances]
    effects = [coordinate.is_log for effect in hypothesis.effects for coordinate in effect.coordinates]
    return np.array([*nuisances, *effects]) > 0


def _number(path: FieldPath, value: float, *, is_log: bool) -> RobotNumber:
    schema = shape.schema if (shape := _shape(path)) else {}
    low = float(schema.get("minimum", schema.get("exclusiveMinimum", -np.inf)))
    high = float(schema.get("maximum", schema.get("exclusiveMaximum", np.inf)))
    inside = min(max(value, low), high)
    is_log = is_log and inside > 0.0
    return RobotNumber(
        path, _unit(path), is_log, log(inside) if is_log else inside, max(low, 0.0) if is_log else low, high
    )


def _shape(path: FieldPath) -> Shape | None:
    """Return what is allowed for a number, by the schema of its section, as that of the whole robot takes long."""
    is_of_effect = path[0] == "effects"
    section = EFFECTS.by_name()[str(path[1])] if is_of_effect else RobotConfig.model_fields[str(path[0])].annotation
    if not isinstance(section, type) or not issubclass(section, Section):
        return None
    shape: Shape | None = Shape.from_model(section)
    for key in path[2:] if is_of_effect else path[1:]:
        shape = shape.below(key) if shape else None
    return shape


def _unit(path: FieldPath) -> str:
    if path[0] == "effects":
        return EFFECTS.by_name()[str(path[1])].parameters()[str(path[2])].unit
    return next((unit for end, unit in UNITS.items() if str(path[-1]).endswith(f"_{end}")), "")


def _root(covariance: Array) -> Array:
    """Return a matrix whose product with its transpose is the covariance, which may be singular."""
    values, vectors = np.linalg.eigh(covariance)
    return np.asarray(vectors, dtype=np.float64) * np.sqrt(np.maximum(values, 0.0))


def _triangular(root: Array) -> Array:
    """Return the lower triangular matrix with the same product with its transpose."""
    if not root.size:
        return np.zeros((len(root), 0))
    lower = np.transpose(np.linalg.qr(root.T)[1])
    sign = np.where(np.diag(lower) < 0.0, -1.0, 1.0)
    lower = np.tril(lower * sign)
    return np.where(np.abs(lower) > ROUNDING * np.linalg.norm(lower, axis=1, keepdims=True), lower, 0.0)
