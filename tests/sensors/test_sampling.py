"""When sensors sample, and what is delivered at a control tick."""

from dataclasses import dataclass, field

import numpy as np
import pytest

from sensors.base import Sampling, Sensor, quantise
from sensors.suite import SensorSuite


@dataclass
class SteppingWorld:
    steps: int = 0

    def advance(self, steps: int) -> None:
        assert steps >= 0
        self.steps += steps

    def pose(self):
        return (float(self.steps), 0.0, 0.0)

    def cast(self, origins, ends):
        raise NotImplementedError

    def encoder_counts(self):
        return (0, 0)


@dataclass
class Clock(Sensor):
    """Reads the step at which it was sampled."""

    sampling: Sampling
    sampled: list[int] = field(default_factory=list)

    def sample(self, world):
        self.sampled.append(world.steps)
        return np.array([world.steps])


def test_a_33_ms_sensor_hands_a_50_ms_reader_its_newest_sample():
    suite = SensorSuite({"tof": Clock(Sampling.from_seconds(0.033, 0.0, 1000))}, tick_steps=50)
    world = SteppingWorld()
    read = [int(suite.read_at_tick(world, tick)["tof"][0]) for tick in range(7)]
    assert read == [0, 33, 99, 132, 198, 231, 297]


def test_a_delay_holds_a_sample_back():
    suite = SensorSuite({"tof": Clock(Sampling.from_seconds(0.033, 0.020, 1000))}, tick_steps=50)
    world = SteppingWorld()
    read = [int(suite.read_at_tick(world, tick)["tof"][0]) for tick in range(5)]
    # At 150 ms the newest sample that is at least 20 ms old is that of 99 ms, for 132 is only 18 ms old.
    assert read == [0, 0, 66, 99, 165]


def test_a_delay_longer_than_a_tick_works():
    suite = SensorSuite({"tof": Clock(Sampling(10, 120))}, tick_steps=50)
    world = SteppingWorld()
    read = [int(suite.read_at_tick(world, tick)["tof"][0]) for tick in range(6)]
    assert read == [0, 0, 0, 30, 80, 130]


def test_the_world_stands_at_the_tick_when_the_readings_come():
    suite = SensorSuite({"a": Clock(Sampling(7, 3)), "b": Clock(Sampling(33, 0))}, tick_steps=50)
    world = SteppingWorld()
    for tick in range(4):
        suite.read_at_tick(world, tick)
        assert world.steps == 50 * tick


def test_samples_that_nobody_reads_are_not_taken():
    fast = Clock(Sampling(1, 0))
    suite = SensorSuite({"fast": fast}, tick_steps=50)
    world = SteppingWorld()
    for tick in range(4):
        suite.read_at_tick(world, tick)
    assert fast.sampled == [0, 50, 100, 150]


@pytest.mark.parametrize(
    ("value", "step", "expected"), [(0.1234, 0.001, 0.123), (0.1236, 0.001, 0.124), (0.1236, 0.0, 0.1236)]
)
def test_quantisation_rounds_to_whole_steps(value, step, expected):
    assert quantise(np.array([value]), step)[0] == pytest.approx(expected, abs=1e-12)
