"""With the made drives of test_whole_runs, whose wheels are known."""

import importlib.util
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from diagnosis.diagnose import diagnose
from diagnosis.report.sentences.run_ends import run_ends


@pytest.fixture(scope="module")
def made():
    place = Path(__file__).parents[2] / "inference" / "evidence" / "test_whole_runs.py"
    spec = importlib.util.spec_from_file_location("whole_runs_cases", place)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_extended_robot_of_known_wheels_ends_nearer_than_the_nominal_one(made):
    """Planted: radii 40.0 and 40.2 mm for 40, a track of 202.4 mm for 200; two runs of nine are held out."""
    measurement = made.measured(runs=9)
    held = (replace(t, holdout=np.full(len(t.t_s), k in {2, 5})) for k, t in enumerate(measurement.trials))
    diagnosis = diagnose(replace(measurement, trials=tuple(held)))
    drive = diagnosis.extended.drive
    assert drive.track_m == pytest.approx(0.2024, abs=4e-4)
    (sentence, *more) = run_ends(diagnosis)
    assert not more
    before, after = (float(sentence.split(" mm and ")[k].split()[-1]) for k in (0, 1))
    assert "rms of 2 runs" in sentence
    assert after < 0.5 * before
