"""Sizes that no robot has are told from those that are only large."""

import pytest

from diagnosis.inference.plausible import LIMITS, beyond
from physics.effects import PHYSICS_TERMS
from sensors.effects import SENSOR_TERMS

NUMBERS = {
    (term.name, name): number for term in (*PHYSICS_TERMS, *SENSOR_TERMS) for name, number in term.numbers.items()
}


def test_a_source_of_twenty_ohms_is_ruled_out_and_one_of_half_an_ohm_is_not():
    (found,) = beyond("supply_sag", {"source_resistance_ohm": 20.0}, {"source_resistance_ohm": 1.0})
    assert (found.parameter, found.limit) == ("source_resistance_ohm", 1.0)
    assert "cells" in found.why
    assert not beyond("supply_sag", {"source_resistance_ohm": 0.5}, {"source_resistance_ohm": 0.01})


def test_a_size_is_ruled_out_only_if_it_is_known_to_three_standard_errors():
    assert not beyond("supply_sag", {"source_resistance_ohm": 1.9}, {"source_resistance_ohm": 0.38})
    assert beyond("supply_sag", {"source_resistance_ohm": 1.9}, {"source_resistance_ohm": 0.2})
    assert not beyond("supply_sag", {"source_resistance_ohm": 19.0}, {})


def test_too_small_is_as_impossible_as_too_large():
    (found,) = beyond("torque_constant_scale", {"scale": 0.3}, {"scale": 0.05})
    assert found.limit == 0.7


def test_what_has_no_limit_is_never_ruled_out():
    assert not beyond("marker_offset", {"offset_m": 0.4}, {"offset_m": 1e-3})


@pytest.mark.parametrize(("name", "parameter"), LIMITS, ids=lambda of: of)
def test_a_limit_is_of_a_number_that_there_is_and_leaves_room_for_its_start(name, parameter):
    number = NUMBERS[name, parameter]
    limit = LIMITS[name, parameter]
    assert number.low <= limit.low < limit.high <= number.high
    assert limit.low <= number.null <= limit.high
    assert limit.low <= number.start <= limit.high
