"""What speaks against an effect, on fits that are given by their costs alone."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from diagnosis.inference.fitting.likelihood import NoiseFit
from diagnosis.inference.selection import refusal as refusals
from diagnosis.inference.selection.refusal import (
    heldout_falls,
    is_at_bound,
    is_far_below_a_row,
    is_within_statement,
    refusal,
)
from sensors.effects.range_sensor.noise_scale import NoiseScale
from sensors.effects.range_sensor.range_offset import RangeOffset
from tests.diagnosis.inference.selection.known_fits import A, B, C, fake_fit

NO_ROWS = np.zeros(0)
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
        ((3.0, 2.0), (np.sqrt(_cost(3.0, 2.0) + 0.2), 1.0), False, 0.0),
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
        "better by the same noise, and else only a little worse",
        "noise",
        "a little worse by the same noise",
        "worse by less noise",
        "worse by more noise",
    ],
)
def test_held_out_rows_speak_against_an_effect_of_the_mean_only_by_the_same_noise_too(
    monkeypatch, before, after, of_noise, fall
):
    monkeypatch.setattr(refusals, "is_of_noise", lambda *_: of_noise)
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


def test_the_time_between_two_rows_does_not_count_the_time_between_two_trials():
    """Rows of 1 s in trials that begin 100 s after each other; 0.06 s are more than a twentieth of a row."""
    times_s = np.array([0.0, 1.0, 100.0, 200.0, 300.0, 301.0])
    observed = SimpleNamespace(is_series=True, t_s=times_s, trial=np.array([0, 0, 1, 2, 3, 3]))
    fit: Any = SimpleNamespace(
        evidence=SimpleNamespace(observed=[observed], memo={}),
        hypothesis=SimpleNamespace(parameters=lambda _: slice(0, 1)),
        x=np.array([6.0]),
    )
    effect: Any = SimpleNamespace(coordinates=[_parameter(0.0, is_time=True)])
    assert not is_far_below_a_row(fit, effect)


def test_only_a_factor_on_the_noise_can_be_within_what_is_stated():
    effect: Any = SimpleNamespace(kind=RangeOffset)
    assert not is_within_statement(SimpleNamespace(), effect)


class TestRefusal:
    """An effect that lowers the cost of single rows by known amounts."""

    @pytest.fixture
    def judged(self, monkeypatch):
        """The reason against an effect A beside B and C, by the falls of the rows of the fit and those held out."""

        def judge(
            falls,
            heldout=NO_ROWS,
            prior_fall=0.0,
            *,
            at_bound_after=(),
            at_bound_before=(),
            noise=False,
            cause=False,
            within=False,
        ):
            falls = np.array(falls, dtype=float)
            is_fit = np.arange(len(falls) + len(heldout)) < len(falls)
            evidence: Any = SimpleNamespace(fit=is_fit, heldout=~is_fit)
            costs = np.concatenate([falls, np.array(heldout, dtype=float)])
            before = fake_fit(1000.0, B, C, costs=costs, prior_cost=prior_fall, bound=at_bound_before)
            after = fake_fit(
                1000.0 - falls.sum() - prior_fall, B, C, A, costs=0.0 * costs, prior_cost=0.0, bound=at_bound_after
            )
            monkeypatch.setattr(refusals, "is_negligible", lambda *_: False)
            monkeypatch.setattr(refusals, "is_at_bound", lambda fit, effect: effect in fit.bound)
            monkeypatch.setattr(refusals, "is_of_noise", lambda *_: noise)
            monkeypatch.setattr(refusals, "adequacy", lambda *_: SimpleNamespace(has_cause=cause))
            monkeypatch.setattr(refusals, "is_within_statement", lambda *_: within)
            monkeypatch.setattr(refusals, "heldout_falls", lambda *_: np.array(heldout, dtype=float))
            return refusal(evidence, before, after, A)

        return judge

    @pytest.mark.parametrize(("fall", "reason"), [(15.0, ""), (14.75, "the cost falls by 14.8, and 15 are needed")])
    def test_a_fall_of_15_is_enough(self, judged, fall, reason):
        assert judged(np.full(100, fall / 100)) == reason

    def test_a_rise_of_the_cost_is_no_fall(self, judged):
        assert judged(np.full(100, -0.02)) == "the cost falls by 0.0, and 15 are needed"

    @pytest.mark.parametrize(
        ("rows", "samples", "is_named"), [(100, 5, False), (100, 6, True), (40, 3, False), (40, 4, True)]
    )
    def test_a_small_fall_comes_from_6_samples_or_a_tenth_of_all(self, judged, rows, samples, is_named):
        """Equal falls in k rows count as k; a row that gets worse does not count."""
        falls = np.where(np.arange(rows) < samples, 18.0 / samples, 0.0)
        falls[-1] = -1.0
        assert judged(falls) == ("" if is_named else f"the fall of 17.0 comes from {samples}.0 samples")

    def test_falls_that_count_as_a_little_less_than_6_samples_are_too_few(self, judged):
        """Five falls of 3.25 and one of half of that count as 5.5^2 / (5 + 0.25) = 5.8."""
        falls = np.zeros(100)
        falls[:6] = *[3.25] * 5, 1.625
        assert judged(falls) == "the fall of 17.9 comes from 5.8 samples"

    @pytest.mark.parametrize(("samples", "is_named"), [(2, False), (3, True)])
    def test_an_effect_with_one_parameter_goes_through_one_outlier_but_not_through_three(
        self, judged, samples, is_named
    ):
        """Without the largest fall, those of two other rows must be enough by themselves."""
        falls = np.where(np.arange(100) < samples, 10.0, 0.0)
        assert judged(falls) == ("" if is_named else "the fall of 20.0 comes from 2.0 samples")

    def test_one_row_that_is_enough_beside_a_far_larger_one_is_not_there_by_more_than_chance(self, judged):
        """Falls of 40 and 16 count as 56^2 / (40^2 + 16^2) = 1.7 samples, and an effect with one parameter needs 3."""
        falls = np.zeros(100)
        falls[:2] = 40.0, 16.0
        assert judged(falls) == "the fall of 56.0 comes from 1.7 samples"

    @pytest.mark.parametrize(("falls", "is_named"), [((4.0, 4.0), True), ((4.0, 3.75), False)])
    def test_a_fall_of_8_in_held_out_rows_confirms_few_samples(self, judged, falls, is_named):
        reason = judged(np.where(np.arange(100) < 2, 10.0, 0.0), falls)
        assert reason == ("" if is_named else "the fall of 20.0 comes from 2.0 samples")

    @pytest.mark.parametrize(("fall", "is_named"), [(15.0, True), (14.9, False)])
    def test_held_out_rows_that_confirm_an_effect_do_not_make_it_stronger(self, judged, fall, is_named):
        """They are for the gain, which must be that of rows that chose nothing."""
        assert (not judged(np.full(100, fall / 100), np.full(10, 2.0), 0.0)) is is_named

    @pytest.mark.parametrize(("rows", "each", "is_named"), [(4, 3.0, True), (5, 3.0, False), (5, 1.6, True)])
    def test_held_out_rows_may_get_worse_by_two_standard_deviations_or_by_8(self, judged, rows, each, is_named):
        """Of n equal rises the sum is sqrt(n) times the root of the sum of squares."""
        reason = judged(np.ones(100), np.full(rows, -each))
        assert reason == ("" if is_named else "the cost of the held-out rows rises by 15.0")

    @pytest.mark.parametrize(("prior_fall", "is_named"), [(0.0, False), (10.0, True)])
    def test_nuisances_that_return_into_their_tolerances_count_as_one_sample_more(self, judged, prior_fall, is_named):
        """Two falls of 10 and three of 1 count as 23^2 / 203 = 2.6 samples, and with one more of 10 as 3.6."""
        falls = np.zeros(100)
        falls[:5] = 10.0, 10.0, 1.0, 1.0, 1.0
        reason = judged(falls, prior_fall=prior_fall)
        assert reason == ("" if is_named else "the fall of 23.0 comes from 2.6 samples")

    @pytest.mark.parametrize(("prior_fall", "is_named"), [(10.0, False), (10.5, True), (13.0, True)])
    def test_where_more_than_half_of_the_fall_is_a_nuisance_that_returns_samples_do_not_count(
        self, judged, prior_fall, is_named
    ):
        falls = np.where(np.arange(100) == 0, 20.0 - prior_fall, 0.0)
        assert bool(judged(falls, np.full(9, -1.0), prior_fall)) is not is_named

    @pytest.mark.parametrize(
        ("noise", "cause", "is_named"), [(True, True, False), (True, False, True), (False, True, True)]
    )
    def test_wider_noise_is_named_only_where_the_mean_is_explained(self, judged, noise, cause, is_named):
        reason = judged(np.ones(100), noise=noise, cause=cause)
        assert reason == ("" if is_named else "the mean has structure, which must be explained before the noise")

    @pytest.mark.parametrize(("rows", "noise", "is_named"), [(15, True, False), (16, True, True), (15, False, True)])
    def test_wider_noise_is_named_from_16_samples_on(self, judged, rows, noise, is_named):
        reason = judged(np.ones(rows), noise=noise)
        assert reason == ("" if is_named else "with fewer than 16 samples, noise looks like an error of any other kind")

    def test_noise_within_twice_the_statement_is_no_effect(self, judged):
        reason = judged(np.ones(100), noise=True, within=True)
        assert reason == "the noise may be as large as stated, within a factor of two"

    @pytest.mark.parametrize(
        ("scale", "errors", "is_within"), [(2.0, 1.9, True), (2.0, 2.1, False), (0.5, 2.9, True), (0.5, 3.1, False)]
    )
    def test_noise_is_beyond_the_statement_by_two_errors_or_three_for_less_noise(self, scale, errors, is_within):
        """A level of the noise may be twice as large without the effect, but hardly smaller."""
        effect: Any = SimpleNamespace(kind=NoiseScale)
        change = np.log(scale) + np.copysign(0.1 * errors, scale - 1.0)
        hypothesis = SimpleNamespace(parameters=lambda _: slice(0, 1), null=lambda: np.zeros(1))
        fit: Any = SimpleNamespace(hypothesis=hypothesis, x=np.array([change]), covariance=np.array([[0.01]]))
        assert refusals.is_within_statement(fit, effect) is is_within

    def test_an_effect_at_its_bound_is_refused(self, judged):
        assert judged(np.ones(100), at_bound_after=[A]) == "its size would exceed its bounds"

    def test_the_first_effect_that_is_pushed_to_its_bound_is_named_unless_it_was_there_before(self, judged):
        pushed = judged(np.ones(100), at_bound_after=[B, C])
        assert pushed == "the size of B would then exceed its bounds"
        pushed = judged(np.ones(100), at_bound_after=[B, C], at_bound_before=[B])
        assert pushed == "the size of C would then exceed its bounds"
        assert judged(np.ones(100), at_bound_after=[B, C], at_bound_before=[C, B]) == ""


class TestBounds:
    @pytest.mark.parametrize(
        ("x", "error", "null", "is_ceiling", "expected"),
        [
            # Amplitudes count up to a tenth of their standard error from a bound.
            (0.5, 1.0, 0.0, False, False),
            (0.875, 1.25, 0.0, False, True),
            (0.874, 1.25, 0.0, False, False),
            (-0.875, 1.25, 0.0, False, True),
            (-0.874, 1.25, 0.0, False, False),
            (0.9, 1.25, 0.0, False, True),
            (-0.9, 1.25, 0.0, False, True),
            # Those that the data do not determine, at the bound alone.
            (0.999, np.inf, 0.0, False, False),
            (1.0, np.inf, 0.0, False, True),
            (-1.0, np.inf, 0.0, False, True),
            # An effect whose absence is the bound is not at it.
            (1.0, 0.0, 1.0, False, False),
            (-1.0, 0.0, 1.0, False, True),
            (-1.0, 0.0, -1.0, False, False),
            (1.0, 0.0, -1.0, False, True),
            # Shapes only at the bound itself, whatever their error.
            (0.999, 1.25, None, False, False),
            (1.0, 1.25, None, False, True),
            (-0.999, 1.25, None, False, False),
            (-1.0, 1.25, None, False, True),
            # A step of a fit may end a rounding error beyond it.
            (1.0 + 1e-15, 1.25, None, False, True),
            (-1.0 - 1e-15, 1.25, None, False, True),
            # A limit may be anywhere.
            (1.0, 1.0, 1.0, True, False),
            (-1.0, 1.0, 1.0, True, False),
            (-1.0, 1.0, 0.0, True, False),
            (-1.0, 1.0, None, True, False),
        ],
    )
    def test_a_coordinate_from_minus_1_to_1(self, x, error, null, is_ceiling, expected):
        """Also beside a second coordinate of the same effect that is well within its bounds."""
        inner = SimpleNamespace(null=0.0, is_ceiling=False, low=-9.0, high=9.0)
        outer = SimpleNamespace(null=null, is_ceiling=is_ceiling, low=-1.0, high=1.0)
        effect: Any = SimpleNamespace(coordinates=(inner, outer))
        fit: Any = SimpleNamespace(
            hypothesis=SimpleNamespace(parameters=lambda _: slice(1, 3)),
            x=np.array([99.0, 0.0, x]),
            covariance=np.diag([1.0, 1.0, error**2]),
        )
        assert is_at_bound(fit, effect) is expected
