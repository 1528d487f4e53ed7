"""Effects that a drive hides, and the names that fit as well.

A listed effect is left out of the model and everything else is fitted again. A cause that no table has is not in the
model: it is compared with a run that has the same random numbers and no cause.
"""

from dataclasses import dataclass

import numpy as np

from benchmarks.diagnosis.other_robots.draws import HIDDEN, log_uniform, pick, significant
from benchmarks.diagnosis.other_robots.drives.predicted.stages import Staged
from benchmarks.diagnosis.other_robots.drives.setting import Driven, DriveSetting
from benchmarks.diagnosis.other_robots.effects import Key, Ratios, draw_shapes, first_size, label, scaled
from benchmarks.diagnosis.other_robots.hidden import MAX_RATIO, MIN_RATIO, Entries, Hidden, describe

DRAWS, TURNS = 8, 5


@dataclass
class Candidate:
    """Drawn effects, a run with them, and the fit of their model."""

    hidden: Hidden
    driven: Driven
    staged: Staged
    base: float
    """Smallest weighted sum of squares with these effects."""
    need: float = MIN_RATIO
    """Smallest likelihood ratio of each effect."""

    def is_visible(self) -> bool:
        """Return whether each effect is visible and the robot stayed in the room."""
        return min(self.hidden.ratios) >= self.need and self.driven.inside


class Search:
    """The search for the effects of a case."""

    def __init__(self, setting: DriveSetting, category: str) -> None:
        self.setting, self.category = setting, category

    def hide(self, rng: np.random.Generator, entries: Entries) -> Driven | None:
        """Return a run with hidden effects, or None where none is visible or a listed name explains it."""
        if not HIDDEN[self.category]:
            return self.setting.plain if self.setting.plain.inside else None
        for _ in range(DRAWS):
            candidate = self._candidate(rng)
            if candidate.is_visible():
                return candidate.driven if self._describe(rng, candidate, entries) else None
        return None

    def _candidate(self, rng: np.random.Generator) -> Candidate:
        """Return effects whose sizes are near drawn likelihood ratios."""
        table = self.setting.table
        names = self.setting.outside if self.category == "outside" else self.setting.named
        visible = [name for name in names if self.setting.visible(name)]
        chosen = [str(name) for name in rng.choice(visible, size=HIDDEN[self.category], replace=False)]
        keys: list[Key] = []
        for name in chosen:
            discrete = table[name].discrete
            keys.append((name, pick(rng, discrete[1]) if discrete else None))
        hidden = Hidden(keys, [[first_size(rng, table[name]), *draw_shapes(rng, table[name])] for name in chosen])
        if chosen == ["camera_slow"]:
            hidden.values[0][0] = float(round(hidden.values[0][0]))
        targets = [log_uniform(rng, MIN_RATIO * 1.4, MAX_RATIO) for _ in chosen]
        stages = self.setting.stages_of(chosen)
        candidate = self._fitted(hidden, stages)
        for _ in range(TURNS - 1):
            targets = (
                [max(target, 1.6 * candidate.need) for target in targets] if self.category == "outside" else targets
            )
            if candidate.driven.inside and self._are_close(hidden, targets):
                break
            self._grow(hidden, targets)
            candidate = self._fitted(hidden, stages)
        return candidate

    def _are_close(self, hidden: Hidden, targets: list[float]) -> bool:
        """Return whether the likelihood ratios are near their targets."""
        effects = [self.setting.table[name] for name, _ in hidden.keys]
        pairs = zip(effects, hidden.ratios, targets, strict=True)
        return all(effect.threshold or 0.4 < ratio / target < 2.5 for effect, ratio, target in pairs)

    def _grow(self, hidden: Hidden, targets: list[float]) -> None:
        """Change the sizes towards the targets."""
        for (name, _), values, ratio, target in zip(hidden.keys, hidden.values, hidden.ratios, targets, strict=True):
            effect = self.setting.table[name]
            if not effect.threshold:
                by = float(np.clip(np.sqrt(target / max(ratio, 1.0)), 0.1, 6))
                values[0] = significant(scaled(effect, values[0], by), 5)

    def _fitted(self, hidden: Hidden, stages: str) -> Candidate:
        """Drive with the effects and set their likelihood ratios."""
        setting, deviations = self.setting, self.setting.deviations
        driven = setting.drive(hidden)
        staged = setting.staged(driven.log, stages)
        problem, target = staged.problem, staged.target
        if self.category == "outside":
            plain = setting.staged(setting.plain.log, stages)
            count = staged.measured.mask.sum()
            base = plain.problem.minimum(plain.target, [], deviations) * float(count / plain.measured.mask.sum())
            hidden.ratios = [problem.minimum(target, [], deviations) - base]
            # two runs are compared, and the difference must also exceed what chance makes of it
            return Candidate(hidden, driven, staged, base, MIN_RATIO + 3 * float(np.sqrt(2 * count)))
        base = problem.minimum(target, hidden.keys, hidden.theta(deviations), rounds=3)
        rests = [hidden.without(i) for i in range(len(hidden.keys))]
        hidden.ratios = [problem.minimum(target, rest.keys, rest.theta(deviations)) - base for rest in rests]
        return Candidate(hidden, driven, staged, base)

    def _describe(self, rng: np.random.Generator, candidate: Candidate, entries: Entries) -> bool:
        """Enter the effects; False where a listed name explains an effect outside the list."""
        hidden = candidate.hidden
        described = [
            describe(self.setting.table, *each) for each in zip(hidden.keys, hidden.values, hidden.ratios, strict=True)
        ]
        if self.category == "outside":
            costs = self._rivals(rng, candidate, hidden.keys[0], Hidden())
            best = min(costs.items(), key=lambda cost: cost[1]) if costs else None
            entries.add_outside(described[0], best)
            return best is None or best[1] >= candidate.need
        for i, key in enumerate(hidden.keys):
            entries.add(described[i], self._rivals(rng, candidate, key, hidden.without(i)))
        return True

    def _rivals(self, rng: np.random.Generator, candidate: Candidate, key: Key, rest: Hidden) -> Ratios:
        """Return how much worse other names explain the data, of those that show in the same stages."""
        named, stages, costs = self.setting.named, candidate.staged.stages, {}
        known = {stages: (candidate.staged, candidate.base)}
        taken = {key[0], *(name for name, _ in rest.keys)}
        for name in named:
            wide = self.setting.stages_of([name], stages)
            if name in taken or self.setting.stages_of([name]) == "" or not self._shares(name, stages):
                continue
            if wide not in known:
                if self.category == "outside":
                    continue
                known[wide] = self._with_more_stages(candidate, wide)
            staged, base = known[wide]
            for variant in named[name].variants():
                size = [first_size(rng, named[name]), *draw_shapes(rng, named[name])]
                start = Hidden([], [*rest.values, size]).theta(self.setting.deviations)
                rival = (name, variant)
                cost = staged.problem.minimum(staged.target, [*rest.keys, rival], start, rounds=5)
                costs[label(rival)] = cost - base
        return costs

    def _shares(self, name: str, stages: str) -> bool:
        """Return whether an effect shows in one of the stages."""
        return bool(set(self.setting.stages_of([name])) & set(stages))

    def _with_more_stages(self, candidate: Candidate, stages: str) -> tuple[Staged, float]:
        """Return more stages of a run; those hold a rival that also moves them at its absence."""
        staged, hidden = self.setting.staged(candidate.driven.log, stages), candidate.hidden
        return staged, staged.problem.minimum(
            staged.target, hidden.keys, hidden.theta(self.setting.deviations), rounds=3
        )
