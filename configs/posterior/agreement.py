"""Checks that a posterior and the scenario that draws from it are about the same robot."""

import math
from collections.abc import Iterator

from configs.checks.scenario import check_scenario
from configs.posterior.drawing import mean_robot
from configs.posterior.reading import KEY
from configs.posterior.schema import FILE, Posterior, Value
from configs.schema.scenario import Scenario
from configs.validation.faults import ConfigFault
from configs.validation.values import validated
from symolo.core.errors import shown, together
from symolo.core.yaml.tree import FieldPath, Node, Values, dotted


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
    replaced = {path: value for each in posterior.hypotheses for path, value in each.paths.items()}
    for path, value in sorted(replaced.items(), key=lambda item: dotted(item[0])):
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
            cure=f"write {replaced}, and its value comes from {FILE} (here: --set {dotted(path)}={replaced}); or leave "
            f"out --{KEY}",
        )


def _same(node: Node, value: Value) -> bool:
    """Return whether a scenario has the value that the robot of the diagnosis has."""
    actual = node.plain()
    if isinstance(actual, int | float) and isinstance(value, int | float):
        return math.isclose(actual, value, rel_tol=1e-9, abs_tol=1e-12)
    return actual == value
