"""All sensors of one robot, sampled at their own times while the world advances from one control tick to the next."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sensors.base import Sensor, World

Reading = NDArray[np.float64] | NDArray[np.int64]


class SteppedWorld(World, Protocol):
    """A world that can be moved forward by whole physics steps."""

    @property
    def steps(self) -> int: ...

    def advance(self, steps: int) -> None: ...


@dataclass(frozen=True)
class _Pending:
    """The sample that a future tick will read."""

    step: int
    name: str


class SensorSuite:
    """Runs the world to each control tick and hands over what every sensor has delivered by then."""

    def __init__(self, sensors: Mapping[str, Sensor], tick_steps: int) -> None:
        self._sensors = dict(sensors)
        self._tick_steps = tick_steps
        self._next_tick = dict.fromkeys(self._sensors, 0)
        self._samples: dict[str, dict[int, Reading]] = {name: {} for name in self._sensors}

    def read_at_tick(self, world: SteppedWorld, tick: int) -> dict[str, Reading]:
        """Advance `world` to control tick `tick` and return the delivered reading of each sensor by name.

        Ticks are asked for in order, each once.
        """
        target = tick * self._tick_steps
        while (pending := self._first_pending()).step <= target:
            world.advance(pending.step - world.steps)
            self._sample(pending, world)
        world.advance(target - world.steps)
        return {name: self._deliver(name, target) for name in self._sensors}

    def _first_pending(self) -> _Pending:
        return min(
            (_Pending(self._sample_step(name, tick), name) for name, tick in self._next_tick.items()),
            key=lambda pending: pending.step,
        )

    def _sample_step(self, name: str, tick: int) -> int:
        return self._sensors[name].sampling.step_read_at(tick * self._tick_steps)

    def _sample(self, pending: _Pending, world: World) -> None:
        self._samples[pending.name][pending.step] = self._sensors[pending.name].sample(world)
        while self._sample_step(pending.name, self._next_tick[pending.name]) <= pending.step:
            self._next_tick[pending.name] += 1

    def _deliver(self, name: str, step: int) -> Reading:
        wanted = self._sensors[name].sampling.step_read_at(step)
        samples = self._samples[name]
        for old in [s for s in samples if s < wanted]:
            del samples[old]
        return samples[wanted]
