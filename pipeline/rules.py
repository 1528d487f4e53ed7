"""Rules that code of a user keeps, each with what it means, and the verdicts about them."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from symolo.core.errors import one_line

Trial = TypeVar("Trial")


class BrokenRule(Exception):  # noqa: N818 - an outcome with a name
    """The code breaks a rule; the text says how, and what to do."""


@dataclass(frozen=True)
class Rule(Generic[Trial]):
    """One rule of a contract."""

    name: str
    meaning: str
    test: Callable[[Trial], None]
    """Function that raises BrokenRule."""


@dataclass(frozen=True)
class RuleVerdict:
    """Result of one rule."""

    rule: Rule[Any]
    problem: str
    """Why the code breaks it; empty where it keeps it."""
    is_failure: bool = False
    """Whether the code raised an error, so that the rule could not be tested."""


def verdicts(
    trial: Trial, rules: Sequence[Rule[Trial]], explained: Callable[[BaseException], str]
) -> Iterator[RuleVerdict]:
    """Yield the verdict of each rule; an error in the user's code is one as well, with its explanation."""
    for rule in rules:
        try:
            rule.test(trial)
        except BrokenRule as broken:
            yield RuleVerdict(rule, one_line(str(broken)))
        except (Exception, SystemExit) as error:  # noqa: BLE001 - the code of a user may raise whatever it likes
            yield RuleVerdict(rule, one_line(explained(error)), is_failure=True)
        else:
            yield RuleVerdict(rule, "")


def rule_lines(rules: Sequence[Rule[Any]], judged: Sequence[tuple[str, RuleVerdict]], function: str) -> Iterator[str]:
    """Yield the lines about the rules, each with what it means and its problems.

    Args:
        rules: The rules in their order.
        judged: Name of a choice of parameters, empty for none, and the verdict.
        function: Name of the function of the user that a rule runs.
    """
    for rule in rules:
        rule_verdicts = [(choice, verdict) for choice, verdict in judged if verdict.rule is rule]
        problems = [
            f"{choice}: {one.problem}" if choice else one.problem for choice, one in rule_verdicts if one.problem
        ]
        name, meaning = rule.name, rule.meaning
        if any(verdict.is_failure for _, verdict in rule_verdicts):
            name, meaning = "runs", f"{function} runs without an error"
        yield f"  {'FAILED' if problems else 'ok' if rule_verdicts else '-':<7}{name:<10}{meaning}"
        yield from (f"         {problem}" for problem in problems)
