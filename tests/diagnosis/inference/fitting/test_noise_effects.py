"""Noise that grows with the light beside a level of the noise, against a direct search for the lowest cost."""

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.optimize import minimize

from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.fitting.hypothesis import Hypothesis
from diagnosis.inference.fitting.likelihood import LEVEL_SD, LEVELS, MEAN_SHARE, SHARES, WIDTH
from diagnosis.inference.fitting.noise_effects import fixed_levels
from diagnosis.inference.fitting.standard_errors import standard_errors
from diagnosis.predictors.base import Observed, Predicted
from sensors.effects.range_sensor.ambient_noise import AmbientNoise

SD_M, COEFFICIENT = 0.002, 30.0
KLUX = np.geomspace(0.04, 5.3, 240)


def sd_m(coefficient):
    return SD_M * np.sqrt(1.0 + coefficient * KLUX)


@dataclass
class Lit:
    """A sensor without any error of the mean, under different light."""

    observed: tuple[Observed, ...]
    name: str = "ranges"
    at_once: int = 48

    def predict(self, robots):
        effects = [robot.effects.get(AmbientNoise) for robot in robots]
        sd = np.array([sd_m(effect.coefficient_per_klux if effect else 0.0) for effect in effects])
        return (Predicted(np.zeros_like(sd), sd),)


def readings_m(seed, coefficient, level):
    return level * sd_m(coefficient) * np.random.default_rng(seed).standard_normal(len(KLUX))


def evidence_of(values):
    everywhere = np.ones(len(values), dtype=bool)
    observed = Observed(
        name="reading_m",
        channel="reading_m",
        unit="m",
        values=values,
        sd=np.full(len(values), SD_M),
        correlation=0.0,
        trial=np.zeros(len(values), dtype=int),
        t_s=np.arange(len(values), dtype=float),
        holdout=~everywhere,
        usable=everywhere,
    )
    return Evidence((Lit((observed,)),))


def cost(values, coefficient, level, share):
    """The cost in the words of `likelihood.py`: normal noise or a Cauchy density, and the priors of both numbers."""
    sd = level * sd_m(coefficient)
    good = (1.0 - share) * SD_M / sd * np.exp(-0.5 * (values / sd) ** 2)
    outlier = share * np.sqrt(2.0 / np.pi) / WIDTH / (1.0 + (values / SD_M / WIDTH) ** 2)
    return -2.0 * np.log(good + outlier).sum() + (np.log(level) / LEVEL_SD) ** 2 + 2.0 * share / MEAN_SHARE


def lowest(values):
    """Cost of the best of all coefficients, levels and shares."""
    within = [(np.log(0.1), np.log(100.0)), tuple(np.log(LEVELS)), SHARES]
    found = [
        minimize(lambda p: cost(values, np.exp(p[0]), np.exp(p[1]), p[2]), (np.log(start), 0.0, 0.02), bounds=within)
        for start in (5.0, 20.0, 60.0)
    ]
    return min(each.fun for each in found)


@pytest.fixture(scope="module")
def fitted(robot, effect):
    lit = effect("ambient_noise")
    hypothesis = Hypothesis(robot, (), (lit,))

    def of(values):
        evidence = evidence_of(values)
        (fit,) = fits(evidence, [(hypothesis, hypothesis.null())])
        return hypothesis.values(lit, fit.x)["coefficient_per_klux"], fit, standard_errors(evidence, fit, lit)

    return of


@pytest.mark.parametrize(("coefficient", "level"), [(30.0, 1.0), (30.0, 1.5), (60.0, 1.0), (60.0, 0.8)])
def test_a_fit_ends_at_the_lowest_cost_of_effect_and_level_together(fitted, coefficient, level):
    for seed in range(3):
        values = readings_m(seed, coefficient, level)
        _, fit, _ = fitted(values)
        assert fit.cost <= lowest(values) + 0.1


def test_the_coefficient_is_as_far_off_as_its_standard_error_says(fitted):
    """Over levels that are drawn from their prior, deviations in standard errors have a standard deviation of one."""
    deviations = []
    for seed in range(32):
        level = np.exp(LEVEL_SD * np.random.default_rng([seed, 1]).standard_normal())
        coefficient, _, std = fitted(readings_m(seed, COEFFICIENT, level))
        deviations.append((coefficient - COEFFICIENT) / std["coefficient_per_klux"])
    assert np.max(np.abs(deviations)) < 3.5
    assert 0.6 < np.std(deviations) < 1.4


def test_a_factor_on_the_noise_takes_the_place_of_its_level_although_rounding_adds_to_it(robot, effect):
    """Readings in millimetres with a noise of 1 to 10 mm that is 2.5 times the stated one."""
    hypothesis = Hypothesis(robot, (), (effect("noise_scale"),))
    sd = 2.5 * np.geomspace(0.001, 0.010, len(KLUX))
    spreads = (sd**2 / (sd**2 + 0.001**2 / 12.0))[None]
    assert fixed_levels(evidence_of(np.zeros(len(KLUX))), hypothesis, spreads).all()


def test_noise_that_grows_with_the_light_leaves_the_level_uncertain(robot, effect):
    hypothesis = Hypothesis(robot, (), (effect("ambient_noise"),))
    spreads = (0.5 * 60.0 * KLUX / (1.0 + 60.0 * KLUX))[None]
    assert not fixed_levels(evidence_of(np.zeros(len(KLUX))), hypothesis, spreads).any()
