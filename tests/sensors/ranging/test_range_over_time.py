"""Ranges that depend on more than one moment: means over a time, and errors that wander."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import numpy as np
import pytest

from configs.effects.base import Effect, Slot
from configs.effects.parameter import Parameter
from configs.effects.robot_effects import RobotEffects
from sensors.effects.range_sensor.range_gathering_time import RangeGatheringTime
from sensors.effects.range_sensor.range_wander import RangeWander
from sensors.ranging.tof import TofArray
from sensors.suite import SensorSuite
from symolo.dataset.codes import TofStatus

TICK_STEPS = 50


@dataclass
class MovingWall:
    """A wall across the x axis whose distance is a function of time; a step is a millisecond."""

    plane_world: type
    wall_x_m: Callable[[float], float]
    steps: int = 0

    @property
    def time_s(self):
        return 1e-3 * self.steps

    def advance(self, steps):
        assert steps >= 0
        self.steps += steps

    def pose(self):
        return (0.0, 0.0, 0.0)

    def encoder_counts(self):
        return (0, 0)

    def cast(self, origins, ends):
        return self.plane_world(wall_x_m=self.wall_x_m(self.time_s)).cast(origins, ends)


@pytest.fixture
def exact(robot):
    """The sensors without noise, rounding, delay and error."""
    still = {"error_scale": 0.0, "noise_scale": 0.0, "quantisation_m": 0.0, "dropout_probability": 0.0}
    return robot.tof.model_copy(update=still)


@pytest.fixture
def ranges(exact, arena_of, plane_world):
    """Ranges of the front sensor at each control tick, before a wall that moves by a law."""

    def read(effect, wall_x_m, ticks=12, config=exact):
        rng = np.random.Generator(np.random.PCG64(0))
        sensor = TofArray(config, arena_of(), 1000, rng, RobotEffects().with_effect(effect))
        suite = SensorSuite({"tof": sensor}, TICK_STEPS)
        world = MovingWall(plane_world, wall_x_m)
        return np.array([suite.read_at_tick(world, tick)["tof"][0, 0] for tick in range(ticks)])

    return read


@pytest.mark.parametrize("duration_s", [0.02, 0.03, 0.2])
def test_a_wall_that_comes_nearer_is_where_it_was_half_the_time_ago(ranges, duration_s):
    def approaching(time_s):
        return 0.9 - 0.5 * time_s

    now = ranges(RangeGatheringTime(duration_s=0.0), approaching)
    mean = ranges(RangeGatheringTime(duration_s=duration_s), approaching)
    settled = slice(6, None)
    assert (mean - now)[settled] == pytest.approx(0.5 * 0.5 * duration_s, rel=0.02)
    assert mean[0] == now[0]


def test_a_jump_is_shared_between_old_and_new_as_the_time_is(ranges):
    """A sample is taken at 594 ms, 30 ms after the wall has jumped; 40 ms are gathered."""

    def jumping(time_s):
        return 0.4 if time_s < 0.564 else 0.6

    before, after = (ranges(RangeGatheringTime(duration_s=0.0), lambda _, x=x: x)[-1] for x in (0.4, 0.6))
    read = ranges(RangeGatheringTime(duration_s=0.04), jumping, ticks=13)
    assert read[-1] == pytest.approx(0.25 * before + 0.75 * after, abs=0.1 * (after - before))
    assert read[-2] == before


def test_time_in_which_nothing_is_hit_does_not_count(ranges):
    gone = ranges(RangeGatheringTime(duration_s=0.04), lambda time_s: 1e9 if time_s < 0.564 else 0.6, ticks=13)
    there = ranges(RangeGatheringTime(duration_s=0.0), lambda _: 0.6, ticks=13)
    assert gone[-1] == pytest.approx(there[-1], abs=1e-12)


@pytest.fixture
def gathers(exact, arena_of, plane_world):
    """The sensors with a gathering time of 100 ms, and a wall at a distance before the front one, at a time."""
    effects = RobotEffects().with_effect(RangeGatheringTime(duration_s=0.1))
    sensor = TofArray(exact, arena_of(), 1000, np.random.Generator(np.random.PCG64(0)), effects)

    def wall(distance_m, time_s):
        return plane_world(wall_x_m=exact.mounts.front.x_m + distance_m, time_s=time_s)

    return sensor, wall


WHITE_M = 0.00025
"""White board reads this much long (Table 3)."""


@pytest.mark.parametrize(("duration_s", "steps"), [(0.04, (40, 35, 30, 25, 20, 15, 10, 5)), (0.002, (2, 1)), (0.0, ())])
def test_light_is_gathered_in_8_even_subsamples_of_whole_steps_before_a_sample(exact, arena_of, duration_s, steps):
    effects = RobotEffects().with_effect(RangeGatheringTime(duration_s=duration_s))
    sensor = TofArray(exact, arena_of(), 1000, np.random.Generator(np.random.PCG64(0)), effects)
    assert sensor.sampling.subsamples_before == steps


def test_a_reading_is_the_mean_of_straight_lines_through_the_subsamples_of_the_gathering_time(gathers):
    """Means of the three stretches: 0.25 m over 10 ms, 0.4 m over 30 ms and 0.45 m over 60 ms.

    The subsample at 0.69 s is too old, and that at 0.7 s just counts, though 0.8 - 0.1 > 0.7 for a computer.
    """
    sensor, wall = gathers
    for time_s, distance_m in ((0.69, 1.0), (0.7, 0.2), (0.71, 0.3), (0.74, 0.5)):
        sensor.subsample(wall(distance_m, time_s))
    assert sensor.sample(wall(0.4, 0.8))[0, 0] == pytest.approx((0.0025 + 0.012 + 0.027) / 0.1 + WHITE_M)
    # A sample is itself a subsample of the next one.
    assert sensor.sample(wall(0.6, 0.85))[0, 0] == pytest.approx(0.5 + WHITE_M)


def test_a_target_that_has_gone_at_the_sample_is_no_target_and_one_that_has_just_come_is_read(gathers):
    sensor, wall = gathers
    sensor.subsample(wall(0.3, 0.45))
    assert sensor.sample(wall(1e9, 0.5))[0].tolist() == [2.0, TofStatus.NO_TARGET]
    assert sensor.sample(wall(0.3, 0.7))[0] == pytest.approx([0.3 + WHITE_M, TofStatus.VALID])


class MixedWithLast(Effect):
    slot = Slot.RANGE
    cause = "a filter in the sensor"
    excitation = "distances that change between the readings"

    share: Annotated[float, Parameter("1", null=0.0, start=0.2, low=0.0, high=0.9)]

    def apply(self, reading_m, view):
        return reading_m + self.share * (view.previous_distance_m - view.distance_m)


def test_an_effect_sees_the_distance_at_the_reading_before_and_at_the_first_one_the_present_one(
    exact, arena_of, plane_world
):
    effects = RobotEffects().with_effect(MixedWithLast(share=0.25))
    sensor = TofArray(exact, arena_of(), 1000, np.random.default_rng(0), effects)
    walls = [plane_world(wall_x_m=exact.mounts.front.x_m + distance_m) for distance_m in (0.4, 0.6, 0.2)]
    read_m = [sensor.sample(wall)[0, 0] - WHITE_M for wall in walls]
    assert read_m == pytest.approx([0.4, 0.6 - 0.25 * 0.2, 0.2 + 0.25 * 0.4])


class Deviates:
    """A generator that gives these rows of standard normal deviates."""

    def __init__(self, rows):
        self._rows = iter(np.array(rows))

    def standard_normal(self, size):
        row = next(self._rows)
        assert row.shape == (size,)
        return row


def test_a_random_drift_keeps_what_time_leaves_of_it_and_gains_the_rest(exact, arena_of, plane_world, monkeypatch):
    """First-order Gauss-Markov of 3 mm and 2 s: e' = r e + sqrt(1 - r^2) 3 mm z, with r = 1/2 after 2 ln 2 s.

    The first error is one of the stationary process: it has been going on before.
    """
    effects = RobotEffects().with_effect(RangeWander(sd_m=0.003, time_constant_s=2.0))
    sensor = TofArray(exact, arena_of(), 1000, np.random.Generator(np.random.PCG64(3)), effects)
    monkeypatch.setattr(sensor, "_drift_rng", Deviates([[1.0, -2.0, 0.5], [2.0, 1.0, 0.0], [0.0, 0.0, 0.0]]))
    times_s = (10.0, 10.0 + 2.0 * np.log(2.0), 10.0 + 6.0 * np.log(2.0))
    read_mm = [1e3 * sensor.sample(plane_world(wall_x_m=0.5, time_s=time_s))[:, 0] for time_s in times_s]
    still = TofArray(exact, arena_of(), 1000, np.random.default_rng(0)).sample(plane_world(wall_x_m=0.5))[:, 0]
    errors = np.array([[3.0, -6.0, 1.5], [1.5 + np.sqrt(27.0), -3.0 + np.sqrt(6.75), 0.75]])
    assert np.array(read_mm) - 1e3 * still == pytest.approx(np.array([*errors, errors[1] / 4.0]))


def test_a_random_drift_has_its_deviation_and_forgets_exponentially(exact, arena_of, plane_world):
    """First-order Gauss-Markov: neighbours that are 0.5 s apart have a correlation of exp(-0.5 / 2).

    Three sensors with 1500 samples each are worth 4500 (1 - r)/(1 + r) = 560 independent ones, r = exp(-0.25).
    """
    effects = RobotEffects().with_effect(RangeWander(sd_m=0.003, time_constant_s=2.0))
    sensor = TofArray(exact, arena_of(), 1000, np.random.Generator(np.random.PCG64(3)), effects)
    read = np.array([sensor.sample(plane_world(wall_x_m=0.5, time_s=0.5 * k))[:, 0] for k in range(1500)])
    error = read - TofArray(exact, arena_of(), 1000, np.random.default_rng(0)).sample(plane_world(0.5))[:, 0]
    assert error.std() == pytest.approx(0.003, rel=0.1)
    assert abs(error.mean()) < 3.0 * 0.003 / np.sqrt(560.0)
    for lag in (1, 4):
        pairs = (error[lag:] * error[:-lag]).mean() / (error**2).mean()
        assert pairs == pytest.approx(np.exp(-0.25 * lag), abs=0.08)
    assert abs(np.corrcoef(error.T)[0, 1]) < 3.0 / np.sqrt(190.0)


def test_the_noise_is_the_same_with_and_without_a_wandering_error(exact, arena_of, plane_world):
    noisy = exact.model_copy(update={"noise_scale": 1.0})
    readings = []
    for sd_m in (0.0, 0.01):
        effects = RobotEffects().with_effect(RangeWander(sd_m=sd_m, time_constant_s=1e4))
        sensor = TofArray(noisy, arena_of(), 1000, np.random.Generator(np.random.PCG64(3)), effects)
        readings.append([sensor.sample(plane_world(wall_x_m=0.5, time_s=0.01 * k))[0, 0] for k in range(5)])
    apart = np.subtract(*readings)
    assert abs(apart[0]) > 1e-4
    assert apart == pytest.approx(apart[0], abs=2e-4)
