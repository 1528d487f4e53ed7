"""The measured sets and the example cases beside the checkout; run where they are there (see conftest.py).

Expected values are counted with the shell's tools or are those of the sets' own descriptions.
"""

import importlib
import json
from pathlib import Path

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.loader import load_section
from diagnosis.importers import IMPORTERS
from diagnosis.importers.blind import read_blind
from diagnosis.importers.choose import read_measurement
from diagnosis.importers.optiodom import ENCODER_TICKS_PER_REVOLUTION, TRACK_M, WHEEL_DIAMETER_M
from diagnosis.inference.evidence.whole_runs import WholeRuns, fitted_to_whole_runs
from diagnosis.inference.hypothesis import Hypothesis
from diagnosis.measured.channel import Quality
from diagnosis.measured.measurement import Kind
from diagnosis.measured.noise import noise_of_differences, noise_of_residuals
from diagnosis.measured.screening import noise_of, spikes, usable
from diagnosis.measured.write_case import csv_of, write_case
from diagnosis.nominal_robot import nominal_robot
from diagnosis.nuisances import nuisances
from diagnosis.predictors import STAGES
from pipeline.diagnosing.case_reading import Reading

SHARED = Path(__file__).parents[4] / "shared"
MEASURED, EXAMPLES = SHARED / "measured", SHARED / "gap_examples"

ANSWERS = json.loads((EXAMPLES / "answers.json").read_text())


def read(path):
    return read_measurement(path, IMPORTERS)


@pytest.mark.parametrize(
    "folder", sorted(path.parent for path in EXAMPLES.glob("*/nominal.yaml")), ids=lambda p: p.name
)
def test_an_example_case_is_read_whole_and_comes_back(folder, tmp_path):
    found = read(folder)
    assert found.kind == folder.name.rpartition("_")[0]
    lines = (folder / "data.csv").read_text().splitlines()[1:]
    assert found.rows == len(lines)
    assert found.heldout_rows == sum(",holdout," in line for line in lines)
    assert not any("CHECK" in note for note in found.notes)
    write_case(found, tmp_path / folder.name)
    again = read(tmp_path / folder.name)
    assert csv_of(again) == csv_of(found)
    assert again.nominal == found.nominal


@pytest.mark.parametrize("number", [1, 2, 3])
def test_noise_of_a_step_log_is_found_without_a_model(number):
    """0.012 A and 0.1 rad/s by its nominal file; what the signal bends comes on top, and most in lively trials."""
    found = read(EXAMPLES / f"motor_step_{number:03}")
    for name, sd in (("current_A", 0.012), ("omega_rad_s", 0.1)):
        median = np.median([noise_of(trial[name]).sd for trial in found.trials])
        assert 0.9 * sd < median < 1.3 * sd


def test_optiodom_counts_and_camera_agree_on_the_way():
    """On the straight runs, counts times the nominal wheel's circumference are the camera's way within 3 %."""
    found = read(MEASURED / "optiodom_diff" / "ivanjko" / "250620201618")
    straight = [trial for trial in found.trials if np.ptp(trial["theta_rad"].values) < 0.5]
    assert len(straight) >= 2
    for trial in straight:
        counts = 0.5 * (trial["enc_left_ticks"].values[-1] + trial["enc_right_ticks"].values[-1])
        way_m = counts / ENCODER_TICKS_PER_REVOLUTION * np.pi * WHEEL_DIAMETER_M
        seen_m = np.hypot(*(trial[name].values[-1] - trial[name].values[0] for name in ("x_m", "y_m")))
        assert way_m == pytest.approx(seen_m, rel=0.03)


def test_optiodom_turns_left_where_the_right_wheel_goes_further():
    found = read(MEASURED / "optiodom_diff" / "circular" / "250620202104")
    per_tick_m = np.pi * WHEEL_DIAMETER_M / ENCODER_TICKS_PER_REVOLUTION
    for trial in found.trials:
        turned = per_tick_m * (trial["enc_right_ticks"].values[-1] - trial["enc_left_ticks"].values[-1]) / TRACK_M
        assert turned == pytest.approx(trial["theta_rad"].values[-1], rel=0.1)


@pytest.mark.parametrize("session", ["square/230620202144", "circular/250620202104"])
def test_held_out_runs_end_no_further_off_than_by_a_calibration_of_the_trade(session, monkeypatch):
    """Least squares over whole paths for both diameters and the track, with a code of its own, on the same runs."""
    monkeypatch.syspath_prepend(str(Path(__file__).parents[3] / "benchmarks" / "diagnosis"))
    trade = importlib.import_module("wheel_calibrations")
    found = read(MEASURED / "optiodom_diff" / session)
    held = np.array([trial.holdout.all() for trial in found.trials])
    robot = nominal_robot(found.nominal, draw_robot(load_section("robot", "nominal"), 1, "test")[0])
    bare = Hypothesis(robot, nuisances(found.nominal))
    ours = WholeRuns(found, robot).errors(fitted_to_whole_runs(found, bare, bare.null(), ()).robot)[held, -1]
    runs = [np.loadtxt(file, delimiter=",", encoding="utf-8-sig") for file in found.source.files]
    nominal = trade.Wheels(WHEEL_DIAMETER_M, WHEEL_DIAMETER_M, TRACK_M)
    fit = [run for run, is_held in zip(runs, held, strict=True) if not is_held]
    wheels = trade.by_whole_paths(fit, nominal, ENCODER_TICKS_PER_REVOLUTION)
    judged = [run for run, is_held in zip(runs, held, strict=True) if is_held]
    ends = {
        of: np.array([trade.odometry(run, of, ENCODER_TICKS_PER_REVOLUTION)[-1] - run[-1, 1:4] for run in judged])
        for of in (nominal, wheels)
    }
    before, theirs = (np.sqrt(np.mean(np.square(ends[of]), axis=0)) for of in (nominal, wheels))
    after = np.sqrt(np.mean(ours**2, axis=0))
    assert np.hypot(*after[:2]) <= np.hypot(*theirs[:2]) < np.hypot(*before[:2])
    assert after[2] <= theirs[2]


def test_a_set_is_read_with_the_runs_held_out_that_are_asked_for():
    found = Reading(held_out=("circular/*", "ivanjko/*")).measurement(MEASURED / "optiodom_diff")
    held = {trial.name.split("/")[0]: bool(trial.holdout.all()) for trial in found.trials}
    assert held == {"circular": True, "ivanjko": True, "square": False}
    one = Reading(part="left wheel").measurement(MEASURED / "opatiny_micromouse" / "wheelSpeedCalibration3.csv")
    assert {trial.part for trial in one.trials} == {"left wheel"}


def test_stale_speeds_of_the_micromouse_are_marked():
    """By its description those below 15 rpm or so are stale; -24.10 rpm stands in 12 rows of the left wheel."""
    left, _ = read(MEASURED / "opatiny_micromouse" / "wheelSpeedCalibration5.csv").trials
    stale = left["omega_rad_s"].quality == Quality.STALE
    text = (MEASURED / "opatiny_micromouse" / "wheelSpeedCalibration5.csv").read_text()
    assert np.count_nonzero(stale) >= text.count(" -24.10,") - 1 > 5
    assert np.abs(left["omega_rad_s"].values[stale]).max() < 30 * np.pi / 30


@pytest.mark.parametrize("path", sorted((MEASURED / "opatiny_micromouse").glob("*.csv")), ids=lambda p: p.stem)
def test_every_log_of_the_micromouse_is_read(path):
    lines = path.read_text().splitlines()
    rows = sum(line.count(",") == lines[0].count(",") for line in lines[1:])
    found = read(path)
    assert all(len(trial.t_s) == rows for trial in found.trials)
    assert any("is broken" in note for note in found.notes) == (path.stem == "testPid4")
    assert 0.0 < found.trials[0].t_s[-1] < 700.0


def test_a_floor_of_the_robotino_is_24_drives_at_a_third_of_a_tenth_of_a_second():
    found = read(MEASURED / "robotino_slip" / "one_surface_type" / "brown_surface")
    assert len(found.trials) == 24
    assert np.median(np.diff(found.trials[0].t_s)) == pytest.approx(0.032, abs=0.002)
    assert found.trials[0]["motor_1_set_rad_s"].values[0] == pytest.approx(-34.641)


@pytest.mark.parametrize(
    "path", sorted((MEASURED / "robotino_slip" / "dc_motor_model_identification").glob("*.csv")), ids=lambda p: p.stem
)
def test_every_motor_log_of_the_robotino_is_read(path):
    assert read(path).rows == len(path.read_text().splitlines()) - 3


def test_the_record_of_a_sensor_at_rest_has_its_noise():
    """2 mm from one reading to the next, as the range bench finds by its Allan deviation."""
    found = read(MEASURED / "tof_vl53l0x_static" / "static_tof_dist_data_1_h.csv")
    (trial,) = found.trials
    noise = noise_of_differences(usable(trial["reading_m"])[:20_000])
    assert found.kind is Kind.OTHER
    assert noise.sd == pytest.approx(2.1e-3, rel=0.15)


def test_the_scan_over_an_apple_is_read():
    (path,) = (MEASURED / "tof_vl53l0x_scan").glob("*.csv")
    found = read(path)
    assert found.rows == len(path.read_text().splitlines()) - 1
    assert not found.trials[0].is_timed


def trimmed_rms(z):
    """As the format defines a case's error: the largest 3 % of absolute values and what is missing left out."""
    z = np.sort(np.abs(z[np.isfinite(z)]))
    return np.sqrt(np.mean(z[: round(0.97 * len(z))] ** 2))


def nominal_residuals(case):
    """The measurement, and of each quantity what was observed and measured less predicted, at every row."""
    found = read(EXAMPLES / case)
    robot = nominal_robot(found.nominal, draw_robot(load_section("robot", "nominal"), 1, "test")[0])
    (stage,) = STAGES[found.kind](found, robot)
    both = zip(stage.observed, stage.predict([robot]), strict=True)
    return found, [(o, np.concatenate([c.values for c in found.across(o.name)]) - p.mean[0]) for o, p in both]


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
        noise = noise_of_residuals(left[~of.holdout])
        assert noise.sd == pytest.approx(sd, rel=0.1)
        assert noise.correlation == pytest.approx(0.3, abs=0.1)


@pytest.mark.parametrize(
    "path", sorted(EXAMPLES.glob("*/blind_*.csv")), ids=lambda path: f"{path.parent.name}-{path.stem}"
)
def test_the_unseen_runs_of_an_example_are_read_whole(path):
    kind = Kind(path.parent.name.rpartition("_")[0])
    found = read_blind(path.parent, kind)[path.name]
    assert found.rows == found.heldout_rows == len(path.read_text().splitlines()) - 1


def test_wild_samples_of_a_step_log_are_found_without_a_model():
    """Those that the nominal motor shows to be eight standard deviations off, in a case without an effect."""
    found, residuals = nominal_residuals("motor_step_001")
    wild, spiky, begin = set(), set(), 0
    for k, trial in enumerate(found.trials):
        rows = slice(begin, begin + len(trial.t_s))
        for of, left in residuals:
            off = np.abs(left[rows]) > 8.0 * of.sd[rows]
            wild |= {(k, of.name, row) for row in np.flatnonzero(off).tolist()}
            spiky |= {(k, of.name, row) for row in np.flatnonzero(spikes(trial[of.name])).tolist()}
        begin = rows.stop
    assert spiky <= wild
    assert len(spiky) >= 0.7 * len(wild) > 4
