"""Numbers of a file beside fitted ones."""

from dataclasses import replace
from math import nan, pi
from types import SimpleNamespace
from typing import Annotated, Any

import pytest

from configs.effects.base import Effect, Slot
from configs.effects.parameter import Parameter
from diagnosis.inference.fitting.hypothesis import CandidateEffect
from diagnosis.inference.fitting.motor_scales import UNSCALED
from diagnosis.inference.naming.file_numbers import agree, file_numbers


class StatedWave(Effect):
    slot = Slot.RANGE
    cause = "none, for a test"
    excitation = "distance"

    swing_m: Annotated[float, Parameter("m", null=0.0, start=0.02, low=-1.0, high=1.0, std=0.003)]
    length_m: Annotated[float, Parameter("m", null=None, start=0.3, low=0.01, high=1.0)]
    phase_rad: Annotated[float, Parameter("rad", null=None, start=3.0, low=-6.3, high=6.3, is_angle=True, std=0.3)]


class StatedTop(Effect):
    slot = Slot.SPEED_READING
    cause = "none, for a test"
    excitation = "speed"

    top_rad_s: Annotated[float, Parameter("rad/s", null=100.0, start=5.0, low=0.1, high=100.0, std=0.1)]
    other_rad_s: Annotated[float, Parameter("rad/s", null=100.0, start=7.0, low=0.1, high=100.0)]


STD = {"swing_m": 0.004, "length_m": 0.01, "phase_rad": 0.4}


def compared(swing_m, phase_rad, std=STD):
    values = {"swing_m": swing_m, "length_m": 0.9, "phase_rad": phase_rad}
    fit: Any = SimpleNamespace(hypothesis=SimpleNamespace(values=lambda *_: values), x=None)
    evidence: Any = None
    return file_numbers(evidence, fit, CandidateEffect(StatedWave), std)


def test_the_difference_is_in_combined_standard_errors():
    """hypot(3, 4) = 5; a number that the file states without an error, such as the length, is only a start."""
    swing, phase = compared(0.035, 3.5)
    assert (swing.name, swing.apart) == ("swing_m", pytest.approx(3.0))
    assert (phase.name, phase.apart) == ("phase_rad", pytest.approx(1.0))


def test_a_number_further_than_three_standard_errors_is_another_one():
    assert agree(compared(0.0349, 3.0))
    assert not agree(compared(0.0351, 3.0))


def test_an_equal_number_agrees_though_its_error_is_not_known():
    numbers = compared(0.02, 3.0, std={**STD, "swing_m": nan})
    assert [number.apart for number in numbers] == [0.0, 0.0]
    assert agree(numbers)


def test_a_turn_is_no_difference():
    _, phase = compared(0.02, 3.0 - 2.0 * pi)
    assert phase.apart == pytest.approx(0.0, abs=1e-9)


def test_a_wave_of_the_other_sign_half_a_turn_further_is_the_same():
    assert agree(compared(-0.02, 3.0 - pi))
    assert not agree(compared(-0.02, 3.0))


def test_a_fit_begins_at_the_measured_numbers_whatever_the_size_of_the_motor():
    """A start without an error is that of the motor of the paper, and is scaled."""
    candidate = CandidateEffect(StatedWave, scales=replace(UNSCALED, speed=3.0))
    assert [each.value(each.start) for each in candidate.coordinates] == pytest.approx([0.02, 0.3, 3.0])
    candidate = CandidateEffect(StatedTop, scales=replace(UNSCALED, speed=3.0))
    assert [each.value(each.start) for each in candidate.coordinates] == pytest.approx([5.0, 21.0])
