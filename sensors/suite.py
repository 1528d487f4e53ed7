"""All sensors of one robot, each sampled at its own times while the world advances from tick to tick."""

from collections.abc import Iterator, Mapping
from typing import Protocol

import numpy as np

from sensors.base import Reading, Sensor, World
from symolo.core.arrays import Array
from symolo.core.tables.time_series import TimeSeries
from symolo.dataset.tables.column import Series
from symolo.dataset.tables.sensor_tables import SERIES


class SteppedWorld(World, Protocol):
    """A world that can be moved forward by whole physics steps."""

    @property
    def steps(self) -> int: ...

    def advance(self, steps: int) -> None: ...


class SensorSuite:
    """Runs the world to each control tick and returns the readings that every sensor has delivered by then."""

    def __init__(self, sensors: Mapping[str, Sensor], tick_steps: int) -> None:
        self._sensors = dict(sensors)
        self._tick_steps = tick_steps
        self._next_tick = dict.fromkeys(self._sensors, 0)
        self._next_step = dict.fromkeys(self._sensors, 0)
        """Physics step of the sample that the next tick reads, by sensor; the first samples are at the start."""
        self._subsamples: dict[str, list[int]] = {name: [] for name in self._sensors}
        """Physics steps before the next sample at which a sensor looks at the world, by sensor."""
        self._samples: dict[str, dict[int, Reading]] = {name: {} for name in self._sensors}
        self._logged: dict[str, list[tuple[int, Array]]] = {
            name: [] for name, sensor in sensors.items() if sensor.is_listed()
        }
        """Every sample of each sensor of `robot.sensors` with its step; of the others only those that are read are
        taken."""

    def samples(self, physics_hz: int) -> Iterator[TimeSeries]:
        """Yield the samples so far of each sensor of `robot.sensors`, (N, columns)."""
        for name, logged in self._logged.items():
            steps, readings = zip(*logged, strict=True)
            sensor = self._sensors[name]
            units = ", ".join(column.unit for column in sensor.columns_of(sensor.settings))
            yield TimeSeries(SERIES.format(name=name), units, np.array(steps) / physics_hz, np.stack(readings))

    def recorded(self, readings: Mapping[str, Reading]) -> Iterator[tuple[Series, Reading]]:
        """Yield each series of the sensors that every robot has with its next row.

        Args:
            readings: The result of `read_at_tick`.
        """
        for name, sensor in self._sensors.items():
            if name not in self._logged:
                yield from zip(sensor.series, sensor.recorded(readings[name]), strict=True)

    def read_at_tick(self, world: SteppedWorld, tick: int) -> dict[str, Reading]:
        """Advance `world` to control tick `tick` and return the delivered reading of each sensor by name.

        Call this once for each tick, in order.
        """
        target = tick * self._tick_steps
        while (due := self._due(first := min(self._sensors, key=self._due))) <= target:
            world.advance(due - world.steps)
            if self._subsamples[first]:
                self._subsamples[first].pop(0)
                self._sensors[first].subsample(world)
            else:
                self._sample(first, world)
        world.advance(target - world.steps)
        return {name: self._deliver(name, target) for name in self._sensors}

    def _due(self, name: str) -> int:
        subsamples = self._subsamples[name]
        return subsamples[0] if subsamples else self._next_step[name]

    def _sample(self, name: str, world: World) -> None:
        sensor, step = self._sensors[name], self._next_step[name]
        reading = self._samples[name][step] = sensor.sample(world)
        if name in self._logged:
            self._logged[name].append((step, sensor.checked(reading, world.time_s)))
            self._next_step[name] += sensor.sampling.period_steps
        while self._next_step[name] <= step:
            self._next_tick[name] += 1
            self._next_step[name] = sensor.sampling.step_read_at(self._next_tick[name] * self._tick_steps)
        subsamples = (self._next_step[name] - before for before in sensor.sampling.subsamples_before)
        self._subsamples[name] = [subsample for subsample in subsamples if subsample > step]

    def _deliver(self, name: str, step: int) -> Reading:
        delivered = self._sensors[name].sampling.step_read_at(step)
        samples = self._samples[name]
        for old in [s for s in samples if s < delivered]:
            del samples[old]
        return samples[delivered]
