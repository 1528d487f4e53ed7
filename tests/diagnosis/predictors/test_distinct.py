import pytest

from configs.draw import draw_robot
from configs.effects.base import Slot
from configs.loader import load_section
from diagnosis.predictors.distinct import distinct
from physics.effects.encoder_ticks_scale import EncoderTicksScale
from physics.effects.supply_sag import SupplySag
from sensors.effects.range_scale import RangeScale


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
