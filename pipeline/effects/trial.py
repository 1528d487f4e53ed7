"""One effect in the experiments, with its readings and the calls of its function."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product
from types import MappingProxyType

import numpy as np

from configs.effects.base import Effect, Slot
from configs.effects.parameter import Parameter
from configs.schema.robot import RobotConfig
from pipeline.effects.calls import Call, recorded
from pipeline.effects.probe import Probe, Readings

ANY_NAME: Mapping[str, tuple[str, ...]] = MappingProxyType({"material": ("white_board",)})
"""Values of parameters that take any name."""
OF_PLACES = frozenset({Slot.FRICTION, Slot.TRAVEL, Slot.TURNING, Slot.POSE_HEADING, Slot.CREEP})
"""Slots whose effects may act at places, at times, or in ways of moving that no short drive reaches."""
KEPT_CALLS = 24
"""Calls that the rules repeat; they are spread over all that were recorded."""


@dataclass
class EffectTrial:
    """An effect with one choice of its parameters that are not numbers."""

    effect: type[Effect]
    choices: Mapping[str, str] = field(default_factory=dict)
    probe: Probe = field(default_factory=Probe)
    has_engine: bool = True
    """Whether PyBullet drives as well."""

    @property
    def name(self) -> str:
        return "-".join((self.effect.name, *self.choices.values()))

    @cached_property
    def start(self) -> Effect:
        return self.effect.start(self.choices)

    @property
    def is_for_bench(self) -> bool:
        """Whether no drive can have the effect: play in a gear needs two masses."""
        return self.effect.slot is Slot.GEARBOX

    def robot(self, effect: Effect) -> RobotConfig:
        return self.probe.robot.with_effect(effect)

    def places(self) -> dict[str, str]:
        """Return the method of the probe by the name of each experiment that can have the effect."""
        drives = {"twin": "in_twin"} | ({"engine": "in_engine"} if self.has_engine else {})
        floor = {"floor": "on_floor"} if self.effect.slot in OF_PLACES else {}
        return {**({} if self.is_for_bench else drives), "bench": "on_bench", **floor}

    def read(self, place: str, effect: Effect) -> Readings:
        """Return the readings of an experiment with the effect."""
        return getattr(self.probe, self.places()[place])(self.robot(effect))

    def bare(self, place: str) -> Readings:
        """Return the readings of an experiment without any effect."""
        return self.probe.bare(self.places()[place])

    @cached_property
    def _at_start(self) -> tuple[dict[str, Readings], list[Call]]:
        readings, calls = {}, []
        for place in self.places():
            with recorded(self.effect) as some:
                readings[place] = self.read(place, self.start)
            calls += some
        return readings, calls

    @property
    def at_start(self) -> Mapping[str, Readings]:
        """The readings at the start value, by experiment."""
        return self._at_start[0]

    @cached_property
    def calls(self) -> tuple[Call, ...]:
        """Calls of the function at the start value, in all experiments."""
        every = self._at_start[1]
        spread = np.linspace(0, len(every) - 1, min(len(every), KEPT_CALLS)).astype(int)
        return tuple(every[k] for k in spread)

    def other_values(self) -> Iterator[tuple[str, Effect]]:
        """Yield the effect with one number elsewhere and the others at their start, with the number in words.

        Values that contradict each other are left out.
        """
        for name, number in self.effect.parameters().items():
            for value in dict.fromkeys((number.low, number.high, *_between(number))):
                changed = self.start.model_copy(update={name: value})
                if not list(changed.faults(in_simulation=False)):
                    yield name, changed


def _between(number: Parameter) -> tuple[float, ...]:
    """Return values within the bounds: half and twice the start, and those half way to the bounds and to null."""
    ends = (number.low, number.high, *([] if number.null is None else [number.null]))
    near = (0.5 * number.start, 1.2 * number.start, 2.0 * number.start)
    return tuple(v for v in (*near, *(0.5 * (number.start + end) for end in ends)) if number.low <= v <= number.high)


def trials(effect: type[Effect], probe: Probe, *, has_engine: bool = True) -> tuple[EffectTrial, ...]:
    """Return one trial for each combination of an effect's choices."""
    options = {name: ANY_NAME.get(name, allowed) for name, allowed in effect.options().items()}
    every = (dict(zip(options, values, strict=True)) for values in product(*options.values()))
    return tuple(EffectTrial(effect, choices, probe, has_engine) for choices in every)
