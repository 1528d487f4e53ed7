"""`symolo effect check`: the verdict of every rule about the effect of a file, in words."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from configs.effects.base import Effect
from configs.effects.registry import EFFECTS
from pipeline.effects.closest import Resemblance, closest
from pipeline.effects.contract import RULES, judged
from pipeline.effects.listing import settings_of
from pipeline.effects.probe import Probe
from pipeline.effects.trial import EffectTrial, trials
from pipeline.rules import RuleVerdict, rule_lines
from symolo.core.errors import InputError

MIN_SHARE = 0.05
"""Share of the change from which an effect resembles another."""


@dataclass(frozen=True)
class CheckedEffect:
    """The verdicts about one effect."""

    effect: type[Effect]
    verdicts: tuple[tuple[str, RuleVerdict], ...]
    """Name of the choice of parameters that are not numbers, empty if there is none, and the verdict."""
    resembles: Resemblance | None
    """The most similar shipped effect of the same slot."""

    @property
    def is_good(self) -> bool:
        return not any(verdict.problem for _, verdict in self.verdicts)

    @property
    def settings(self) -> tuple[str, ...]:
        """The start values as settings of a scenario."""
        return settings_of(self.effect)


def check(path: Path) -> CheckedEffect:
    """Load the effect of a file and test all rules.

    Raises:
        InputError: The file cannot be loaded.
    """
    effect = EFFECTS.load(path)
    tried = trials(effect, Probe())
    verdicts = [(", ".join(trial.choices.values()), verdict) for trial in tried for verdict in _verdicts(trial)]
    is_good = not any(verdict.problem for _, verdict in verdicts)
    return CheckedEffect(effect, tuple(verdicts), closest(tried[0]) if is_good else None)


def load_to_fit(path: Path) -> type[Effect]:
    """Load the effect of a file that a fit is to try, after a test of the rules that need no engine.

    Raises:
        InputError: The file cannot be loaded, or its effect breaks a rule.
    """
    effect = EFFECTS.load(path)
    rules = [rule for rule in RULES if rule.name not in {"settings", "distinct"}]
    for trial in trials(effect, Probe(), has_engine=False):
        for verdict in judged(trial, rules):
            if verdict.problem:
                cure = f"`symolo effect check {path}` explains it"
                broken = "" if verdict.is_failure else f" breaks the rule '{verdict.rule.name}'"
                what = f"effect {effect.name}{broken}: {verdict.problem}"
                raise InputError(what, where=str(path), cure=cure)
    return effect


def _verdicts(trial: EffectTrial) -> Iterator[RuleVerdict]:
    """Yield the verdicts, up to that of an effect that does not run at all, which the others would repeat."""
    for verdict in judged(trial):
        yield verdict
        if verdict.problem and verdict.rule.name == "form":
            return


def check_text(checked: CheckedEffect) -> Iterator[str]:
    """Yield the lines about the result, each rule with what it means."""
    yield f"{checked.effect.name}, in the slot '{checked.effect.slot}': {checked.effect.cause}"
    yield from rule_lines(RULES, checked.verdicts, "apply")
    if not checked.is_good:
        return
    if checked.resembles is None or checked.resembles.share < MIN_SHARE:
        yield "No shipped effect of its slot resembles it."
        return
    name, share = checked.resembles.name, 100.0 * min(checked.resembles.share, 0.999)
    yield (
        f"The shipped effect that resembles it most is {name}: fitted to the change of all readings of this check, it"
        f" leaves {100.0 - share:.1f} % of it. Data in which both agree cannot distinguish them."
    )
