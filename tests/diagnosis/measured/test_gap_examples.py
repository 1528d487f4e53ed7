"""The example cases of the format: they are read whole, and noise and wild samples are as their authors stated.

Expected values are counted with the shell's tools or are those of the examples' own descriptions.
"""

import json

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.loader import load_section
from diagnosis.examples.example import FOLDER as EXAMPLES
from diagnosis.importers import IMPORTERS
from diagnosis.importers.cases.blind import read_blind
from diagnosis.importers.choose import read_measurement
from diagnosis.measured.case_files.write_case import csv_of, write_case
from diagnosis.measured.measurement import CaseKind
from diagnosis.measured.noise import trimmed_variance
from diagnosis.measured.screening import noise_of, spikes
from diagnosis.nominal_robot import nominal_robot
from diagnosis.predictors import STAGES

ANSWERS = json.loads((EXAMPLES / "answers.json").read_text())


def read(path):
    return read_measurement(path, IMPORTERS)


FOLDERS = sorted(path.parent for path in EXAMPLES.glob("*/nominal.yaml"))
BARE = CaseKind.SYMOLO_CSV.value


@pytest.mark.parametrize("folder", [f for f in FOLDERS if f.name.startswith(BARE)], ids=lambda p: p.name)
def test_a_bare_example_is_read_whole_with_the_rows_from_a_time_on_held_out(folder):
    measurement = read(folder)
    times = [float(line.partition(",")[0]) for line in (folder / "data.csv").read_text().splitlines()[1:]]
    assert measurement.kind == BARE
    assert measurement.rows == len(times)
    assert measurement.heldout_rows == sum(t >= measurement.nominal.holdout_from_ms for t in times) > 0
    assert not any("CHECK" in note for note in measurement.notes)


@pytest.mark.parametrize("folder", [f for f in FOLDERS if not f.name.startswith(BARE)], ids=lambda p: p.name)
def test_an_example_case_is_read_whole_and_comes_back(folder, tmp_path):
    measurement = read(folder)
    assert measurement.kind == folder.name.rpartition("_")[0]
    lines = (folder / "data.csv").read_text().splitlines()[1:]
    assert measurement.rows == len(lines)
    assert measurement.heldout_rows == sum(",holdout," in line for line in lines)
    assert not any("CHECK" in note for note in measurement.notes)
    write_case(measurement, tmp_path / folder.name)
    again = read(tmp_path / folder.name)
    assert csv_of(again) == csv_of(measurement)
    assert again.nominal == measurement.nominal


@pytest.mark.parametrize("number", [1, 2, 3])
def test_noise_of_a_step_log_is_found_without_a_model(number):
    """0.012 A and 0.1 rad/s by its nominal file; what the signal bends comes on top, and most in lively trials."""
    measurement = read(EXAMPLES / f"motor_step_{number:03}")
    for name, sd in (("current_A", 0.012), ("omega_rad_s", 0.1)):
        median = np.median([noise_of(trial[name]).sd for trial in measurement.trials])
        assert 0.9 * sd < median < 1.3 * sd


def trimmed_rms(z):
    """As the format defines a case's error: the largest 3 % of absolute values and what is missing left out."""
    z = np.sort(np.abs(z[np.isfinite(z)]))
    return np.sqrt(np.mean(z[: round(0.97 * len(z))] ** 2))


def nominal_residuals(case):
    """The measurement, and of each quantity what was observed and measured less predicted, at every row."""
    measurement = read(EXAMPLES / case)
    robot = nominal_robot(measurement.nominal, draw_robot(load_section("robot", "nominal"), 1, "test")[0])
    (stage,) = STAGES[measurement.kind](measurement, robot)
    both = zip(stage.observed, stage.predict([robot]), strict=True)
    return measurement, [
        (o, np.concatenate([c.values for c in measurement.across(o.name)]) - p.mean[0]) for o, p in both
    ]


@pytest.mark.parametrize("case", sorted(name for name in ANSWERS if name.startswith("motor")))
def test_the_nominal_motor_is_as_far_off_as_its_answer_says(case):
    """The answer has the gain of the true model, which leaves noise alone: 0.91 sigma with the largest 3 % left out."""
    _, residuals = nominal_residuals(case)
    z = [(left / of.sd)[of.holdout] for of, left in residuals]
    left = trimmed_rms(np.concatenate(z)) * (1.0 - ANSWERS[case]["oracle_gain"])
    assert left == pytest.approx(0.91, abs=0.09)


def test_what_the_nominal_motor_leaves_has_the_stated_noise():
    """0.012 A, 0.1 rad/s and a correlation of 0.3, to which a deviation within tolerance adds."""
    _, residuals = nominal_residuals("motor_step_001")
    for (of, left), sd in zip(residuals, (0.012, 0.1), strict=True):
        fitted = left[~of.holdout]
        # By sum and difference of neighbours (Gnanadesikan and Kettenring, Biometrics 28 (1972) 81-124).
        same, opposite = (trimmed_variance(fitted[1:] + sign * fitted[:-1]) for sign in (1, -1))
        assert np.sqrt(trimmed_variance(fitted)) == pytest.approx(sd, rel=0.1)
        assert (same - opposite) / (same + opposite) == pytest.approx(0.3, abs=0.1)


@pytest.mark.parametrize(
    "path", sorted(EXAMPLES.glob("*/blind_*.csv")), ids=lambda path: f"{path.parent.name}-{path.stem}"
)
def test_the_unseen_runs_of_an_example_are_read_whole(path):
    kind = CaseKind(path.parent.name.rpartition("_")[0])
    measurement = read_blind(path.parent, kind)[path.name]
    assert measurement.rows == measurement.heldout_rows == len(path.read_text().splitlines()) - 1


def test_wild_samples_of_a_step_log_are_found_without_a_model():
    """Those that the nominal motor shows to be eight standard deviations off, in a case without an effect."""
    measurement, residuals = nominal_residuals("motor_step_001")
    wild, spiky, begin = set(), set(), 0
    for k, trial in enumerate(measurement.trials):
        rows = slice(begin, begin + len(trial.t_s))
        for of, left in residuals:
            off = np.abs(left[rows]) > 8.0 * of.sd[rows]
            wild |= {(k, of.name, row) for row in np.flatnonzero(off).tolist()}
            spiky |= {(k, of.name, row) for row in np.flatnonzero(spikes(trial[of.name])).tolist()}
        begin = rows.stop
    assert spiky <= wild
    assert len(spiky) >= 0.7 * len(wild) > 4
