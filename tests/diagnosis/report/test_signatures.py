"""Signatures against closed forms, on a bench that is swept forward only."""

import math

import numpy as np
import pytest

from configs.effects.registry import EFFECTS
from diagnosis.diagnose import diagnose
from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.fitting.hypothesis import CandidateEffect, Hypothesis
from diagnosis.report.signatures import signatures

BY_NAME = EFFECTS.by_name()
NAMES = ("current_sensor_offset", "speed_scale", "coulomb_friction_scale", "friction_asymmetry")


@pytest.fixture(scope="module")
def signed_case(motor_bench_case, tmp_path_factory):
    """Return the signatures and the evidence of a sweep forward; without nuisances nothing is projected out."""
    folder = motor_bench_case(tmp_path_factory.mktemp("signatures") / "forward", sweeps=1)
    diagnosis = diagnose(read_measurement(folder, IMPORTERS))
    (bare,) = fits(diagnosis.evidence, [(Hypothesis(diagnosis.nominal, ()), np.zeros(0))])
    return signatures(diagnosis.evidence, bare, [CandidateEffect(BY_NAME[name]) for name in NAMES]), diagnosis.evidence


def weight_of(rows):
    """Weight of the rows of a current with a noise of 1 mA, in rows.

    At 0.25 V the noise of the speed, 0.04 rad/s, hides whether the motor turns. The current is known from the measured
    speed there, to K / R times this noise.
    """
    hidden_A = math.hypot(0.001, 0.3 / 3.0 * 0.04)
    return rows - 1 + (0.001 / hidden_A) ** 2


def row(matrix, name):
    (signature,) = (r for r in matrix.rows if r.effect.name == name)
    return signature


def test_an_offset_of_30_mA_moves_a_current_of_1_mA_noise_by_30_sigma_and_no_speed(signed_case):
    signature = row(signed_case[0], "current_sensor_offset")
    assert signed_case[0].quantities == ("current_A", "omega_rad_s")
    rows = np.count_nonzero(signed_case[1].fit[signed_case[1].places[0]])
    assert signature.moves == pytest.approx((30.0 * math.sqrt(weight_of(rows) / rows), 0.0))
    assert signature.spreads == (1.0, 1.0)


def test_the_smallest_offset_that_would_be_named_falls_with_the_root_of_the_rows(signed_case):
    """n rows hold a mean to sd / sqrt(n), and the fall of the cost from which its name stands is 19."""
    matrix, evidence = signed_case
    rows = np.count_nonzero(evidence.fit[evidence.places[0]])
    expected = math.sqrt(19.0) * 0.001 / math.sqrt(weight_of(rows))
    assert row(matrix, "current_sensor_offset").smallest == pytest.approx(expected)


def test_a_scale_of_the_speed_moves_it_in_proportion(signed_case):
    matrix, evidence = signed_case
    volts = 0.25 * np.arange(21)
    speed = np.maximum(0.3 * volts / 3.0 - 0.02, 0.0) / (0.3**2 / 3.0 + 0.002)
    fitted = evidence.fit[evidence.places[1]]
    expected = 0.15 * math.sqrt(np.mean(speed[fitted] ** 2)) / 0.04
    assert row(matrix, "speed_scale").moves == pytest.approx((0.0, expected), rel=1e-6)


def test_in_one_direction_an_asymmetry_of_friction_looks_like_less_of_it(signed_case):
    """Tc (1 - a) and s Tc are the same with s = 1 - a; an offset of the current moves no speed and is another."""
    pairs = [{a, b} for a, b, _ in signed_case[0].alike]
    assert pairs == [{"coulomb_friction_scale", "friction_asymmetry"}]
