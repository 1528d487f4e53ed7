"""What speaks against an effect, from rows whose costs are closed forms."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from diagnosis.inference.fitting.likelihood import NoiseFit
from diagnosis.inference.selection import refusal as module
from diagnosis.inference.selection.refusal import heldout_falls, is_far_below_a_row, is_within_statement
from sensors.effects.range_sensor.range_offset import RangeOffset

EFFECT: Any = SimpleNamespace()
ROWS = 3
"""The first is a row of the fit, and two equal rows are held out."""


def _cost(residual, level):
    """Return minus twice the logarithm of a normal density, relative to the greatest one of the stated noise."""
    return (residual / level) ** 2 + 2.0 * np.log(level)


def _fit(residual, level) -> Any:
    """Return a fit of rows that are off by a multiple of their stated noise, without outliers."""
    noise = NoiseFit(np.array([level]), np.array([1e-12]))
    return SimpleNamespace(
        costs=np.full(ROWS, _cost(residual, level)),
        z=np.full(ROWS, residual / level),
        sd=np.full(ROWS, 0.1 * level),
        noise=noise,
    )


@pytest.mark.parametrize(
    ("before", "after", "of_noise", "fall"),
    [
        # (residual, level of the noise) without and with the effect.
        ((3.0, 2.0), (1.0, 1.0), False, _cost(3.0, 2.0) - 1.0),
        # A smaller residual costs more only by the smaller noise with the effect; by the same it costs 0.3 less.
        ((3.0, 2.0), (2.95, 1.0), False, 0.0),
        ((3.0, 2.0), (2.95, 1.0), True, _cost(3.0, 2.0) - 2.95**2),
        # A residual that is a little larger speaks against the effect by what it costs more by the same noise.
        ((3.0, 2.0), (3.05, 1.0), False, 9.0 - 3.05**2),
        # With the smaller noise of both it speaks against the effect even more.
        ((1.0, 2.0), (3.0, 1.0), False, _cost(1.0, 2.0) - 9.0),
        # With the larger noise it speaks against the effect a little less.
        ((1.0, 1.0), (6.0, 2.0), False, _cost(1.0, 2.0) - _cost(6.0, 2.0)),
    ],
    ids=[
        "better",
        "better by the same noise",
        "noise",
        "a little worse by the same noise",
        "worse by less noise",
        "worse by more noise",
    ],
)
def test_held_out_rows_speak_against_an_effect_of_the_mean_only_by_the_same_noise_too(
    monkeypatch, before, after, of_noise, fall
):
    monkeypatch.setattr(module, "is_of_noise", lambda *_: of_noise)
    evidence: Any = SimpleNamespace(
        values=np.zeros(ROWS),
        weight=np.ones(ROWS),
        quantity=np.zeros(ROWS, dtype=np.int64),
        sd=np.full(ROWS, 0.1),
        heldout=np.arange(ROWS) > 0,
    )
    assert heldout_falls(evidence, _fit(*before), _fit(*after), EFFECT) == pytest.approx(np.full(2, fall), abs=1e-6)


def _parameter(null, *, is_time) -> Any:
    return SimpleNamespace(null=null, unit=0.01, is_time=is_time)


@pytest.mark.parametrize(
    ("numbers", "parameters", "expected"),
    [
        # In rows of 1 s, a size of 5 is 0.05 s.
        ([4.9], [_parameter(0.0, is_time=True)], True),
        ([5.0], [_parameter(0.0, is_time=True)], False),
        # Of several times the longest counts, each from where it does nothing.
        ([4.9, 5.1], [_parameter(0.0, is_time=True)] * 2, False),
        ([104.9], [_parameter(100.0, is_time=True)], True),
        # Other numbers are not compared with a row, however small or large they are.
        ([4.9, 99.0, 99.0], [_parameter(0.0, is_time=t) for t in (True, False, False)], True),
        ([0.1], [_parameter(0.0, is_time=False)], False),
        ([4.9, 99.0], [_parameter(0.0, is_time=True), _parameter(None, is_time=True)], True),
    ],
)
def test_the_times_of_an_effect_are_far_below_a_row_up_to_a_twentieth_of_it(numbers, parameters, expected):
    observed = SimpleNamespace(is_series=True, t_s=np.arange(4.0), trial=np.zeros(4))
    fit: Any = SimpleNamespace(
        evidence=SimpleNamespace(observed=[observed], memo={}),
        hypothesis=SimpleNamespace(parameters=lambda _: slice(1, 1 + len(numbers))),
        x=np.array([0.3, *numbers]),
    )
    assert is_far_below_a_row(fit, SimpleNamespace(coordinates=parameters)) is expected


def test_only_a_factor_on_the_noise_can_be_within_what_is_stated():
    effect: Any = SimpleNamespace(kind=RangeOffset)
    assert not is_within_statement(SimpleNamespace(), effect)
