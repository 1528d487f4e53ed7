"""Signatures against closed forms, on a bench that is swept forward only."""

import math

import numpy as np
import pytest

from configs.effects.registry import EFFECTS
from diagnosis.diagnose import diagnose
from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from diagnosis.inference.fit import fits
from diagnosis.inference.hypothesis import CandidateEffect, Hypothesis
from diagnosis.report.signatures import signatures

BY_NAME = EFFECTS.by_name()
NAMES = ("current_sensor_offset", "speed_scale", "coulomb_friction_scale", "friction_asymmetry")


@pytest.fixture(scope="module")
def found(motor_bench_case, tmp_path_factory):
    """Of a sweep forward, without nuisances, so that nothing is projected out; and its evidence."""
    folder = motor_bench_case(tmp_path_factory.mktemp("signatures") / "forward", sweeps=1)
    diagnosis = diagnose(read_measurement(folder, IMPORTERS))
    (bare,) = fits(diagnosis.evidence, [(Hypothesis(diagnosis.nominal, ()), np.zeros(0))])
    return signatures(diagnosis.evidence, bare, [CandidateEffect(BY_NAME[name]) for name in NAMES]), diagnosis.evidence


def row(found, name):
    (of,) = (r for r in found.rows if r.effect.name == name)
    return of


def test_an_offset_of_30_mA_moves_a_current_of_1_mA_noise_by_30_sigma_and_no_speed(found):
    of = row(found[0], "current_sensor_offset")
    assert found[0].quantities == ("current_A", "omega_rad_s")
    assert of.moves == pytest.approx((30.0, 0.0))
    assert of.spreads == (1.0, 1.0)


def test_the_smallest_offset_that_would_be_named_falls_with_the_root_of_the_rows(found):
    """n rows hold a mean to sd / sqrt(n), and the fall of the cost that names it is 15."""
    signature, evidence = found
    rows = np.count_nonzero(evidence.fit[evidence.places[0]])
    expected = math.sqrt(15.0) * 0.001 / math.sqrt(rows)
    assert row(signature, "current_sensor_offset").smallest == pytest.approx(expected)


def test_a_scale_of_the_speed_moves_it_in_proportion(found):
    signature, evidence = found
    volts = 0.25 * np.arange(21)
    speed = np.maximum(0.3 * volts / 3.0 - 0.02, 0.0) / (0.3**2 / 3.0 + 0.002)
    fitted = evidence.fit[evidence.places[1]]
    expected = 0.15 * math.sqrt(np.mean(speed[fitted] ** 2)) / 0.04
    assert row(signature, "speed_scale").moves == pytest.approx((0.0, expected), rel=1e-6)


def test_in_one_direction_an_asymmetry_of_friction_looks_like_less_of_it(found):
    """Tc (1 - a) and s Tc are the same with s = 1 - a; an offset of the current moves no speed and is another."""
    pairs = [{a, b} for a, b, _ in found[0].alike]
    assert pairs == [{"coulomb_friction_scale", "friction_asymmetry"}]
