"""Drives whose wheels are known, made by test_whole_runs: the ends of their runs, and their random slip."""

import importlib.util
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from diagnosis.extended_robot import extended_robot
from diagnosis.posterior.posterior import posterior
from diagnosis.posterior.random_slip import random_slip
from diagnosis.report.sentences.data.random_slip import random_slip_sentences
from diagnosis.report.sentences.data.run_ends import run_ends
from physics.effects.wheels_and_floor.random_slip import RandomSlip


@pytest.fixture(scope="module")
def made():
    place = Path(__file__).parents[3] / "inference" / "evidence" / "test_whole_runs.py"
    spec = importlib.util.spec_from_file_location("whole_runs_cases", place)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_extended_robot_of_known_wheels_ends_nearer_than_the_nominal_one(made, diagnosed_among):
    """Planted: radii 40.0 and 40.2 mm for 40, a track of 202.4 mm for 200; two runs of nine are held out."""
    measurement = made.measured(runs=9)
    held = (replace(t, holdout=np.full(len(t.t_s), k in {2, 5})) for k, t in enumerate(measurement.trials))
    diagnosis = diagnosed_among(replace(measurement, trials=tuple(held)))
    drive = diagnosis.extended.drive
    assert drive.track_m == pytest.approx(0.2024, abs=4e-4)
    (sentence, *more) = run_ends(diagnosis)
    assert not more
    before, after = (float(sentence.split(" mm and ")[k].split()[-1]) for k in (0, 1))
    assert "rms of 2 runs" in sentence
    assert after < 0.5 * before


def test_wheels_that_slip_at_random_have_the_planted_slip(made, diagnosed_among):
    """Each wheel slips by 3 mrad * 40 mm in each of the 400 rows of the first metre: 2.4 mm / sqrt(m)."""
    diagnosis = diagnosed_among(made.measured(runs=16, slip_rad=3e-3))
    slip = random_slip(diagnosis)
    assert abs(np.log(slip.slip_m_sqrt_m / 2.4e-3)) < 3.0 * slip.sd_log
    # 16 squares: a standard error of 18 %.
    assert 0.09 < slip.sd_log < 0.36
    (sentence,) = random_slip_sentences(slip)
    assert f"{1e3 * slip.slip_m_sqrt_m:.1f}" in sentence
    # The robot file has it once, and the posterior draws it once and does not set it besides.
    robot = extended_robot(diagnosis, (slip.effect,))
    assert robot.config.effects.get(RandomSlip).slip_m_sqrt_m == pytest.approx(slip.slip_m_sqrt_m)
    assert re.search(r"slip_m_sqrt_m: 0\.00\d+  # estimated from the headings", robot.text)
    (hypothesis,) = posterior(diagnosis).hypotheses
    drawn = [number.field for number in hypothesis.numbers]
    assert drawn.count("effects.random_slip.slip_m_sqrt_m") == 1
    assert not [each.field for each in hypothesis.fixed if each.field.startswith("effects.random_slip")]


def test_counts_show_the_speeds_of_the_wheels_although_no_voltage_was_logged(made, diagnosed_among):
    """A row of 50 ms has 24 counts on the straight, and up to 16 backwards in the turn on the spot."""
    measured = {each.quantity: each for each in posterior(diagnosed_among(made.measured(runs=4))).measured}
    per_count = 2.0 * np.pi / made.COUNTS / 0.05
    speeds = measured["wheel_speed_rad_s"]
    assert (speeds.low, speeds.high) == pytest.approx((-16 * per_count, 24 * per_count))
    assert "voltage_V" not in measured
