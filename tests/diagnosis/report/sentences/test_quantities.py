"""Numbers and names as people read them."""

import math

import numpy as np
import pytest
from matplotlib.figure import Figure
from scipy.integrate import quad
from scipy.stats import norm

from diagnosis.predictors.base import Covariate, CovariateShape
from diagnosis.report.plots.gain import noise_alone
from diagnosis.report.plots.panels import residual_panel
from diagnosis.report.sentences.quantities import axis, confidence, covariate_axis, meaning, percent, with_error
from physics.effects.encoders.encoder_missed_ticks import EncoderMissedTicks


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (0.92962, 0.0067, "0.9296 ± 0.0067"),
        (0.00465, 0.0002, "0.00465 ± 0.00020"),
        (123.4, 15.0, "123 ± 15"),
        (0.0, 0.01, "0.000 ± 0.010"),
        (1.5, 0.0, "1.5"),
        (1.5, math.inf, "1.5"),
        (1.5, math.nan, "1.5"),
        (1e-12, 2e-13, "1e-12 ± 2e-13"),
    ],
)
def test_a_value_has_as_many_digits_as_its_error_leaves(value, error, text):
    assert with_error(value, error) == text


def test_the_meaning_of_an_effect_is_that_of_its_first_number_and_not_of_its_side():
    assert meaning(EncoderMissedTicks).startswith("Fraction of its ticks that this side loses")


def test_nothing_is_certain():
    assert confidence(1.0) == "over 99.9 %"
    assert confidence(0.694) == "69.4 %"
    assert percent(-0.0523) == "-5.23 %"


def test_axes_have_words_and_units():
    assert axis("u_cmd_V") == "commanded voltage [V]"
    assert axis("ambient_lux") == "ambient light [lx]"
    assert axis("wheel_angle_rad") == "angle of the wheel [rad]"
    assert axis("wheel_angle_rad[left]") == "angle of the wheel, left [rad]"
    assert axis("trial") == "trial"
    assert covariate_axis("omega_rad_s") == "predicted speed of the wheel [rad/s]"


def test_the_error_of_noise_alone_is_that_of_its_smallest_97_percent():
    ends = norm.ppf(0.985)
    within = quad(lambda z: z * z * norm.pdf(z), -ends, ends)[0] / 0.97
    assert noise_alone() == pytest.approx(math.sqrt(within))


def panel(covariate, z):
    axes = Figure().subplots()
    residual_panel(axes, covariate, z, np.zeros(len(z), dtype=bool), "#000000")
    return axes


def test_a_wild_residual_stands_at_the_edge_of_its_panel():
    z = np.zeros(200)
    z[7] = 50.0
    axes = panel(Covariate("t_s", np.arange(200.0)), z)
    low, high = axes.get_ylim()
    assert (low, high) == (-3.5, 3.5)
    shown = np.concatenate([np.stack(line.get_data(), axis=1) for line in axes.lines])
    assert np.any((shown[:, 0] == 7.0) & (shown[:, 1] > 3.0) & (shown[:, 1] < high))


def test_categories_have_their_names_on_the_axis():
    kinds = Covariate("material", np.arange(90) % 3.0, CovariateShape.CATEGORY, labels=("wood", "plastic", "metal"))
    assert [label.get_text() for label in panel(kinds, np.zeros(90)).get_xticklabels()] == ["wood", "plastic", "metal"]


def test_an_angle_is_folded_into_one_turn():
    axes = panel(Covariate("theta_rad", np.linspace(0.0, 60.0, 300), CovariateShape.PERIODIC), np.zeros(300))
    assert axes.get_xlim()[1] < 2.0 * math.pi + 0.5


def test_a_place_is_a_map():
    place = Covariate("position", np.linspace(0.0, 2.0, 50), second=np.linspace(0.0, 1.6, 50))
    axes = panel(place, np.linspace(-2.0, 2.0, 50))
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x [m]", "y [m]")
