"""Waves of torque along the angle of a motor, in step logs of an independent generator."""

import importlib

import numpy as np
import pytest
from scipy.signal import lfilter

from diagnosis.case_robot import base_robot_of, nominal_of, spreads_of
from diagnosis.importers import IMPORTERS
from diagnosis.inference.fitting.fit import fits
from diagnosis.inference.fitting.hypothesis import Hypothesis
from diagnosis.inference.selection.periodogram import waves
from diagnosis.observations import observed_by
from diagnosis.predictors import STAGES
from diagnosis.predictors.turning_response import TurningResponse

READERS = {importer.name: importer for importer in IMPORTERS}
pytestmark = pytest.mark.usefixtures("cases_on_the_path")


@pytest.fixture
def seen(tmp_path):
    """Waves in the residuals of the nominal robot, in the log of a hidden one."""

    def found(seed, *effects):
        cases = importlib.import_module("gap_cases")
        cases.write(cases.make_case("motor_step", seed, effects, rows="few"), tmp_path / "case")
        measurement = READERS["motor_step"].read(tmp_path / "case")
        robot = nominal_of(measurement, base_robot_of(measurement, None))
        bare = Hypothesis(robot, spreads_of(measurement, robot))
        evidence = observed_by(STAGES[measurement.kind](measurement, robot), bare)
        (fit,) = fits(evidence, [(bare, bare.null())])
        return waves(evidence, fit)

    return found


@pytest.mark.parametrize(
    ("seed", "cycles", "amplitude"),
    [
        (1, 14.0, 0.009),
        (4, 1.1, 0.014),
        *(pytest.param(*ripple, marks=pytest.mark.long) for ripple in ((2, 9.4, 0.02), (3, 2.55, 0.011))),
    ],
)
def test_the_first_wave_is_the_hidden_ripple(seen, seed, cycles, amplitude):
    hidden = {"amplitude_N_m": amplitude, "cycles_per_turn": cycles, "phase_rad": 0.7}
    first = seen(seed, ("torque_ripple", hidden))[0]
    assert first.cycles_per_turn == pytest.approx(cycles, abs=0.2)
    assert abs(np.angle(np.exp(1j * (first.phase_rad - 0.7)))) < 0.9
    assert 0.3 * amplitude < first.amplitude_N_m < 1.5 * amplitude


@pytest.mark.parametrize("seed", [3, *(pytest.param(seed, marks=pytest.mark.long) for seed in (1, 2))])
def test_where_nothing_is_hidden_no_wave_is_beyond_chance(seen, seed):
    assert seen(seed) == []


@pytest.fixture
def response():
    """Two trials of a shaft that turns at 4 rad/s, with a time constant of 50 ms."""
    rows = 200
    angle = np.tile(0.02 * np.arange(rows), 2)
    return TurningResponse(angle, np.full(2 * rows, 0.02), np.repeat([0, 1], rows), -20.0, 0.05, 0.005)


def test_the_backward_response_is_the_transpose_of_the_forward_one(response):
    """Of s[k] = a s[k - 1] + scale (1 - a) torque[k], in each trial for itself."""
    rng = np.random.default_rng(1)
    torque, weighted = rng.standard_normal(400), rng.standard_normal(400)
    kept = np.exp(-0.1)
    forward = np.concatenate([lfilter([-20.0 * (1.0 - kept)], [1.0, -kept], part) for part in np.split(torque, 2)])
    assert weighted @ forward == pytest.approx(response.forces(weighted) @ torque)


def test_a_settled_response_is_that_of_a_first_order_lag(response):
    """1 / (1 + (w tau)^2) of the square at rest, with w = cycles * 4 rad/s; a row is a small part of a cycle."""
    cycles = np.array([1.0, 5.0])
    expected = 20.0**2 / (1.0 + (cycles * 4.0 * 0.05) ** 2)
    np.testing.assert_allclose(response.squares(cycles)[:, 100], expected, rtol=0.02)


def test_at_rest_there_is_no_response(response):
    still = TurningResponse(response.angle_rad, np.zeros(400), response.trial, -20.0, 0.05, 0.005)
    assert not still.forces(np.ones(400)).any()
    assert not still.squares(np.array([3.0])).any()
