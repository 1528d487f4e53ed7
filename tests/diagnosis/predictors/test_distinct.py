import weakref

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.effects.base import Slot
from configs.loader import load_section
from diagnosis.predictors.distinct import KnownPredictions, distinct
from physics.effects.driver_and_battery.supply_sag import SupplySag
from physics.effects.encoders.encoder_ticks_scale import EncoderTicksScale
from sensors.effects.range_sensor.range_scale import RangeScale


@pytest.fixture(scope="module")
def robot():
    return draw_robot(load_section("robot", "nominal"), 1, "test")[0]


def test_robots_that_differ_in_nothing_that_acts_are_one(robot):
    scaled, more = (robot.with_effect(RangeScale(scale=scale)) for scale in (1.1, 1.2))
    sagging = robot.with_effect(SupplySag(source_resistance_ohm=0.3))
    heavy = robot.model_copy(update={"motor": robot.motor.model_copy(update={"coulomb_friction_N_m": 0.05})})
    given = [robot, scaled, more, sagging, heavy, robot.with_effect(SupplySag(source_resistance_ohm=0.3))]
    different, which = distinct(given, ("motor",), {Slot.SUPPLY})
    assert which.tolist() == [0, 0, 0, 1, 2, 1]
    assert [different[k] for k in which] == [robot, robot, robot, sagging, heavy, sagging]
    _, by_range = distinct(given, (), {Slot.RANGE})
    assert by_range.tolist() == [0, 1, 2, 0, 0, 0]


def test_no_effect_is_not_a_effect_without_effect(robot):
    """They are predicted alike, but nothing here knows that."""
    _, which = distinct([robot, robot.with_effect(EncoderTicksScale(scale=1.0))], (), {Slot.ENCODER})
    assert which.tolist() == [0, 1]


def sags(robots):
    """Two numbers for each robot, the second one the resistance of its supply."""
    return np.array([[1.0, getattr(robot.effects.get(SupplySag), "source_resistance_ohm", 0.0)] for robot in robots])


def test_robots_that_are_equal_for_a_stage_are_predicted_once(robot):
    batches = []
    stage = KnownPredictions((), {Slot.SUPPLY}, lambda robots: (batches.append(len(robots)), sags(robots))[1])
    sagging = [robot.with_effect(SupplySag(source_resistance_ohm=ohm)) for ohm in (0.3, 0.5)]
    scaled = sagging[0].with_effect(RangeScale(scale=1.1))
    assert stage.predictions([robot, sagging[0], scaled]).tolist() == [[1.0, 0.0], [1.0, 0.3], [1.0, 0.3]]
    assert stage.predictions([sagging[1], scaled, robot]).tolist() == [[1.0, 0.5], [1.0, 0.3], [1.0, 0.0]]
    assert stage.predictions([robot, sagging[1]]).tolist() == [[1.0, 0.0], [1.0, 0.5]]
    assert batches == [2, 1]


def test_the_oldest_predictions_are_forgotten_when_memory_is_short(robot):
    batches = []
    stage = KnownPredictions(
        (), {Slot.SUPPLY}, lambda robots: (batches.append(len(robots)), sags(robots))[1], max_bytes=2 * 16
    )
    several = [robot.with_effect(SupplySag(source_resistance_ohm=ohm)) for ohm in (0.1, 0.2, 0.3)]
    assert stage.predictions(several)[:, 1].tolist() == [0.1, 0.2, 0.3]
    assert stage.predictions(several[1:])[:, 1].tolist() == [0.2, 0.3]
    assert stage.predictions(several[:1])[:, 1].tolist() == [0.1]
    assert batches == [3, 1]


def test_a_batch_does_not_stay_in_memory_with_the_one_prediction_that_is_kept(robot):
    """200 predictions of 16 bytes are one array of 3200 bytes; with room for one of them, 16 bytes may stay."""
    batches = []

    def predict(robots):
        batch = sags(robots)
        batches.append(weakref.ref(batch))
        assert batch.nbytes == 3200
        return batch

    stage = KnownPredictions((), {Slot.SUPPLY}, predict, max_bytes=16)
    ohms = np.linspace(0.001, 0.2, 200)
    several = [robot.with_effect(SupplySag(source_resistance_ohm=ohm)) for ohm in ohms.tolist()]
    assert stage.predictions(several)[:, 1].tolist() == ohms.tolist()
    assert all(batch() is None for batch in batches)
