"""Sizes that no robot has are told from those that are only large."""

import pytest

from configs.effects.registry import EFFECTS
from diagnosis.inference.selection.plausible import beyond
from physics.effects.driver_and_battery.supply_sag import SupplySag
from physics.effects.motor_and_gearbox.torque_constant_scale import TorqueConstantScale
from sensors.effects.pose_log.marker_offset import MarkerOffset

LIMITS = [(effect, name) for effect in EFFECTS.classes() for name in effect.plausible_sizes()]


def test_a_source_of_twenty_ohms_is_ruled_out_and_one_of_half_an_ohm_is_not():
    (found,) = beyond(SupplySag, {"source_resistance_ohm": 20.0}, {"source_resistance_ohm": 1.0})
    assert (found.parameter, found.limit) == ("source_resistance_ohm", 1.0)
    assert "cells" in found.why
    assert not beyond(SupplySag, {"source_resistance_ohm": 0.5}, {"source_resistance_ohm": 0.01})


def test_a_size_is_ruled_out_only_if_it_is_known_to_three_standard_errors():
    assert not beyond(SupplySag, {"source_resistance_ohm": 1.9}, {"source_resistance_ohm": 0.38})
    assert beyond(SupplySag, {"source_resistance_ohm": 1.9}, {"source_resistance_ohm": 0.2})
    assert not beyond(SupplySag, {"source_resistance_ohm": 19.0}, {})


def test_too_small_is_as_impossible_as_too_large():
    (found,) = beyond(TorqueConstantScale, {"scale": 0.3}, {"scale": 0.05})
    assert found.limit == 0.7


def test_what_has_no_limit_is_never_ruled_out():
    assert not beyond(MarkerOffset, {"offset_m": 0.4}, {"offset_m": 1e-3})


@pytest.mark.parametrize(("effect", "parameter"), LIMITS, ids=lambda of: getattr(of, "name", of))
def test_a_limit_is_of_a_number_that_there_is_and_leaves_room_for_its_start(effect, parameter):
    number, limit = effect.parameters()[parameter], effect.plausible_sizes()[parameter]
    assert number.low <= limit.low < limit.high <= number.high
    assert limit.low <= number.null <= limit.high
    assert limit.low <= number.start <= limit.high


def test_the_limits_of_all_effects_are_in_the_list():
    assert (SupplySag, "source_resistance_ohm") in LIMITS
