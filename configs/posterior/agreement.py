"""Checks that a posterior and the scenario that draws from it are about the same robot."""

import math
from collections.abc import Iterator

from configs.checks.scenario import check_scenario
from configs.posterior.drawing import mean_robot
from configs.posterior.reading import KEY
from configs.posterior.schema import FILE, LoadedPosterior, Posterior, Value
from configs.schema.scenario import Scenario
from configs.validation.faults import ConfigFault, is_shipped
from configs.validation.values import validated
from symolo.core.errors import shown, together
from symolo.core.yaml.tree import FieldPath, Node, Values, dotted


def without_shipped_draws(root: Node) -> tuple[Node, tuple[str, ...]]:
    """Return a scenario without the draws that its posterior replaces, and the fields of these draws.

    A shipped scenario draws a field for robots that nobody measured. Where a diagnosis determines the field, it has the
    value of the robot that the diagnosis extends, and each run has that of its drawn robot. What a user draws is left
    to `check_posterior`, which refuses it.

    Args:
        root: Tree of a scenario, with the content of the posterior that it names.
    """
    posterior = root.child(KEY)
    if posterior is None:
        return root, ()
    replaced: list[str] = []
    for path, value in sorted(_replaced(LoadedPosterior.model_validate(posterior.plain())).items()):
        node = root.at(path)
        if node is not None and node.is_distribution and is_shipped(node.where) and value is not None:
            root = _with_value(root, path, Node(value, posterior.where))
            replaced.append(dotted(path))
    return root, tuple(replaced)


def _with_value(root: Node, path: FieldPath, value: Node) -> Node:
    if not path:
        return value
    assert isinstance(root.value, dict) and isinstance(path[0], str)  # noqa: S101, PT018 - the path was found in it
    return Node({**root.value, path[0]: _with_value(root.value[path[0]], path[1:], value)}, root.where)


def _replaced(posterior: Posterior) -> dict[FieldPath, Value]:
    """Return the fields that any hypothesis determines, each with the value of the robot that the diagnosis extends."""
    return {path: value for each in posterior.hypotheses for path, value in each.paths.items()}


def check_posterior(root: Node, posterior: Posterior, values: Values) -> None:
    """Refuse a posterior of another robot than that of the scenario, or of numbers that the scenario sets itself.

    Args:
        root: Tree of the scenario.
        posterior: The posterior that it names.
        values: Values in place of its distributions.

    Raises:
        InputError: For each contradiction; or the robot in the middle of a hypothesis is impossible.
    """
    faults = list(_faults(root, posterior))
    if faults:
        raise together([fault.error(root) for fault in faults])
    for hypothesis in posterior.hypotheses:
        middle = mean_robot(hypothesis).on(root)
        check_scenario(validated(middle, Scenario, values), middle)


def _faults(root: Node, posterior: Posterior) -> Iterator[ConfigFault]:
    name: FieldPath = ("robot", "name")
    if (actual := root.plain_at(name)) != posterior.robot:
        yield ConfigFault(
            name,
            f"the diagnosis of --{KEY} is of another robot",
            actual,
            allowed=posterior.robot,
            cure=f"choose that robot with --set robot={posterior.robot}, or diagnose with --nominal and your robot",
        )
        return
    for path, value in sorted(_replaced(posterior).items(), key=lambda item: dotted(item[0])):
        node = root.at(path)
        if node is None or _same(node, value):
            continue
        replaced = "null" if value is None else shown(value)
        draws = "draws" if node.is_distribution else "sets"
        yield ConfigFault(
            path,
            f"the scenario {draws} it, and --{KEY} too",
            node.plain(),
            allowed=f"{replaced}, as the robot {posterior.robot} has it",
            cure=f"leave it out, and its value comes from {FILE}; or leave out --{KEY}",
        )


def _same(node: Node, value: Value) -> bool:
    """Return whether a scenario has the value that the robot of the diagnosis has."""
    actual = node.plain()
    if isinstance(actual, int | float) and isinstance(value, int | float):
        return math.isclose(actual, value, rel_tol=1e-9, abs_tol=1e-12)
    return actual == value
