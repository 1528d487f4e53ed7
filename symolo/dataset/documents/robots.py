"""How the simulated robots of a dataset deviate from their data sheet, as the documents of the dataset state it.

The settings of a scenario are plain data that may come from a stranger, so each value is read with care.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from symolo.dataset.documents.metadata import Metadata

HYPOTHESIS = "like.hypothesis"
"""Name of the drawn value of a run that says from which hypothesis of a diagnosis its robot was drawn."""


@dataclass(frozen=True)
class SimulatedRobots:
    """Deviations of the robots, and the diagnosis from which they were drawn."""

    diagnosis: str
    """Measurement of the diagnosis and its kind; empty if the robots are not drawn from a diagnosis."""
    model: str
    """Name of the robot that the diagnosis extends."""
    effects: tuple[str, ...]
    """Names of the effects that a robot has in at least one run."""
    left_out: tuple[str, ...]
    """Names of effects that the diagnosis found and that no drive can simulate."""
    ranges: tuple[str, ...]
    """Sentences on where an effect was observed."""
    has_drawn_numbers: bool
    """Whether numbers of the robot were drawn from distributions of the scenario."""

    @classmethod
    def from_metadata(cls, metadata: Metadata) -> "SimulatedRobots":
        robot = _mapping(metadata.scenario.get("robot"))
        like = _mapping(metadata.scenario.get("like"))
        drawn = {run.drawn[HYPOTHESIS] for run in metadata.runs if HYPOTHESIS in run.drawn}
        hypotheses = [each for each in _items(like.get("hypotheses")) if each.get("name") in drawn]
        effects = {str(name) for name, value in _mapping(robot.get("effects")).items() if value is not None}
        effects |= {name for each in hypotheses for name in _effects(each)}
        observed = [*_items(robot.get("effect_ranges"))]
        observed += [one for each in hypotheses for one in _items(each.get("effect_ranges"))]
        left_out = {str(name) for each in hypotheses for name in _list(each.get("left_out"))}
        return cls(
            diagnosis=str(like.get("source", "")) if hypotheses else "",
            model=str(like.get("robot", "")),
            effects=tuple(sorted(effects)),
            left_out=tuple(sorted(left_out)),
            ranges=tuple(dict.fromkeys(map(_range, observed))),
            has_drawn_numbers=any(name.startswith("robot.") for run in metadata.runs for name in run.drawn),
        )

    @property
    def is_as_set(self) -> bool:
        """Whether neither an effect nor a diagnosis changes the robot of the scenario."""
        return not self.effects and not self.diagnosis

    @property
    def text(self) -> str:
        """Sentences for people."""
        effects = ", ".join(self.effects)
        if self.diagnosis:
            parts = [
                f"The robot of each run is drawn from the diagnosis of {self.diagnosis}, which extends {self.model}."
            ]
            parts.append(f"Deviations from its data sheet: {effects}." if effects else "It has no further effect.")
            if self.left_out:
                parts.append(f"The diagnosis also named {', '.join(self.left_out)}, which no drive can simulate.")
            return " ".join(parts)
        if effects:
            return f"Deviations of the robot from its data sheet: {effects}."
        if self.has_drawn_numbers:
            return "Numbers of the robot are drawn for each run; it has no effect beyond its settings."
        return "The robot is as its settings say; it has no effect beyond them."


def robot_of_run(name: str, drawn: Mapping[str, object], diagnosis: str) -> str:
    """Return the name of a run's robot, with the diagnosis from which it was drawn.

    Args:
        name: Name of the robot that was driven or extended.
        drawn: Drawn values of the run.
        diagnosis: Measurement of the diagnosis; empty for none.
    """
    if HYPOTHESIS not in drawn:
        return name
    return f"{name} as in the diagnosis {diagnosis}".rstrip() + f" ({drawn[HYPOTHESIS]})"


def _effects(hypothesis: Mapping[str, Any]) -> Iterator[str]:
    """Yield the effects whose numbers a hypothesis draws or sets."""
    for each in (*_items(hypothesis.get("numbers")), *_items(hypothesis.get("fixed"))):
        section, _, rest = str(each.get("field", "")).partition(".")
        if section == "effects" and each.get("value", 0) is not None:
            yield rest.partition(".")[0]


def _range(seen: Mapping[str, Any]) -> str:
    effect, quantity, low, high = (seen.get(key) for key in ("effect", "quantity", "low", "high"))
    return f"A diagnosis observed {effect} only where {quantity} is from {low} to {high}."


def _mapping(value: object) -> Mapping[str, Any]:
    return value if isinstance(value, Mapping) else {}


def _list(value: object) -> list[Any]:
    return value if isinstance(value, list) else []


def _items(value: object) -> list[Mapping[str, Any]]:
    return [_mapping(item) for item in _list(value)]
