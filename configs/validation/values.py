"""Validation of a tree of values and distributions against the schema; all faults are reported, one line each."""

from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeVar

import numpy as np
from pydantic import BaseModel, ValidationError

from configs.robot_sensors import KNOWN_ONLY
from configs.validation.schema_faults import all_explained
from configs.validation.shapes import Shape
from symolo.core.distributions import Choice, Distribution, Uniform, parse
from symolo.core.errors import FaultList, InputError, apart, together
from symolo.core.yaml.tree import DISTRIBUTION_KINDS, FieldPath, Node, Scalar, Values, dotted

Model = TypeVar("Model", bound=BaseModel)


@dataclass(frozen=True)
class FieldDistribution:
    """A distribution with the type of its field."""

    distribution: Distribution
    is_integer: bool
    is_number: bool

    @property
    def has_options(self) -> bool:
        """Whether it chooses one of a few values."""
        return isinstance(self.distribution, Choice)

    def draw(self, rng: np.random.Generator) -> Scalar:
        if self.is_integer and not isinstance(self.distribution, Choice):
            return self.distribution.draw_integer(rng)
        return self._in_field_type(self.distribution.draw(rng))

    def ends(self) -> tuple[Scalar, ...]:
        """Return the values at which the schema's constraints are checked, from lowest to highest."""
        ends = [self._in_field_type(end) for end in self.distribution.extremes()]
        return tuple(sorted(ends, key=lambda end: (isinstance(end, str), end)))

    def _in_field_type(self, value: Scalar) -> Scalar:
        """Return a value in the type of the field: float for a number, int for a whole number."""
        if isinstance(value, bool) or not isinstance(value, int | float):
            return value
        if self.is_number:
            return float(value)
        return value if isinstance(self.distribution, Choice) else round(value)


def distributions_of(root: Node, model: type[BaseModel]) -> dict[FieldPath, FieldDistribution]:
    """Return the distributions of a tree by path, after a check of their places and kinds.

    Raises:
        InputError: Distributions are malformed, or their fields take none; faults of other fields are named, too.
    """
    distributions, faults = _parsed_distributions(root, model)
    if faults:
        raise together(with_independent(faults, _schema_faults(root, model, distributions)))
    return dict(sorted(distributions.items(), key=lambda item: dotted(item[0])))


def all_faults(root: Node, model: type[BaseModel]) -> list[InputError]:
    """Return the faults of distributions and values, each alone; contradictions between fields are not among them."""
    distributions, faults = _parsed_distributions(root, model)
    return with_independent(faults, _schema_faults(root, model, distributions))


def with_independent(faults: Sequence[InputError], others: Sequence[InputError]) -> list[InputError]:
    """Return faults with those of the others that are about other fields, and not above or below theirs."""
    fields = [f"{fault.field}." for fault in faults]
    return [
        *faults,
        *(other for other in others if not any(_is_within(f"{other.field}.", field) for field in fields)),
    ]


def _is_within(a: str, b: str) -> bool:
    return a.startswith(b) or b.startswith(a)


def _parsed_distributions(
    root: Node, model: type[BaseModel]
) -> tuple[dict[FieldPath, FieldDistribution], list[InputError]]:
    faults, distributions = FaultList(), {}
    for path, node, shape in _distributions(root, Shape.from_model(model), ()):
        with faults.noted():
            distributions[path] = _field_distribution(node, shape, path)
    return distributions, faults.faults


def _schema_faults(
    root: Node, model: type[BaseModel], distributions: Mapping[FieldPath, FieldDistribution]
) -> tuple[InputError, ...]:
    """Return the faults of a tree whose distributions have their lowest values."""
    try:
        validated(root, model, next(probes(distributions)))
    except InputError as error:
        return apart(error)
    return ()


def probes(distributions: Mapping[FieldPath, FieldDistribution]) -> Iterator[Values]:
    """Yield sets of values in which any two distributions take all four combinations of their ends.

    For each bit, the n-th distribution takes its high end if that bit of n is set, and once the opposite; any two
    numbers differ in some bit. The remaining options of choices follow, each once.
    """
    ends = {path: item.ends() for path, item in distributions.items()}
    yield {path: values[0] for path, values in ends.items()}
    if not ends:
        return
    yield {path: values[-1] for path, values in ends.items()}
    for bit in range((len(ends) - 1).bit_length()):
        for turn in (0, 1):
            yield {path: values[-((n >> bit & 1) ^ turn)] for n, (path, values) in enumerate(ends.items())}
    for option in range(1, max(len(values) for values in ends.values()) - 1):
        yield {path: values[min(option, len(values) - 1)] for path, values in ends.items()}


def validated(root: Node, model: type[Model], values: Values) -> Model:
    """Return the model of a tree with these values in place of its distributions."""
    try:
        return model.model_validate(filled(root, values), context=KNOWN_ONLY)
    except ValidationError as error:
        raise together(all_explained(error, root, Shape.from_model(model))) from None


def filled(root: Node, values: Values) -> Any:  # noqa: ANN401 - whatever the file holds
    """Return the plain tree with values in place of distributions, for reading only."""
    by_key: dict[str | int, Any] = {}
    for (*above, key), value in values.items():
        inner = by_key
        for each in above:
            inner = inner.setdefault(each, {})
        inner[key] = value
    return _filled(root, by_key)


def _filled(node: Node, by_key: Mapping[str | int, Any]) -> Any:  # noqa: ANN401 - whatever the file holds
    """Return the plain tree, for reading only: what holds no distribution is the same in all such trees."""
    tree = copy(node.plain_for_reading)
    for key, value in by_key.items():
        child = node.child(key)
        if child is not None:
            tree[key] = _filled(child, value) if isinstance(value, dict) else value
    return tree


def _distributions(node: Node, shape: Shape, path: FieldPath) -> Iterator[tuple[FieldPath, Node, Shape]]:
    """Yield each distribution, and each mapping in the place of one value, with its path and the shape of its field."""
    if isinstance(node.value, dict) and (shape.is_leaf or node.is_distribution):
        yield path, node, shape
        return
    tag = node.child(shape.tag_key)
    if tag is not None and tag.is_distribution:
        yield path, node, shape
        return
    for key, child in node.children():
        inner = shape.child(key, node)
        if inner is not None:
            yield from _distributions(child, inner, (*path, key))


def _field_distribution(node: Node, shape: Shape, path: FieldPath) -> FieldDistribution:
    tag = node.child(shape.tag_key) if shape.tag_key else None
    if tag is not None and tag.is_distribution:
        what, allowed = dotted((*path, shape.tag_key)), f"one of {', '.join(shape.tags)}"
        cure = "no distribution is allowed here, because the other fields depend on it"
        raise InputError(what, where=tag.where, got=tag.plain(), allowed=allowed, cure=cure)
    refusal = partial(InputError, dotted(path), where=node.where, got=node.plain(), allowed=shape.words())
    names = f"it replaces one value; entries, such as sensors, cannot be named {', '.join(DISTRIBUTION_KINDS)}"
    reason = shape.not_drawn if shape.is_leaf else names
    if reason:
        raise refusal(cure=f"no distribution is allowed here, because {reason}" if node.is_distribution else "")
    distribution = parse(node, path)
    if not isinstance(distribution, Choice) and not (shape.is_number or shape.is_integer):
        raise refusal(cure="only {choice: [...]} may draw it")
    if shape.is_integer and isinstance(distribution, Uniform) and any(end % 1 for end in distribution.extremes()):
        raise refusal(cure="the ends of a whole-number field are whole numbers")
    return FieldDistribution(distribution, shape.is_integer, shape.is_number)
