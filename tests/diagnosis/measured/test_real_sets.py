"""The recordings of real robots that docs/diagnosis_evaluation.md names (`-m recordings --recordings=DIR`).

Expected values are counted with the shell's tools or are those of the sets' own descriptions.
"""

import importlib
from pathlib import Path

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.loader import load_section
from diagnosis.diagnose import diagnose
from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from diagnosis.importers.optiodom import ENCODER_TICKS_PER_REVOLUTION, TRACK_M, WHEEL_DIAMETER_M
from diagnosis.inference.evidence.sessions import fitted_errors
from diagnosis.inference.evidence.whole_runs import WholeRuns, fitted_to_whole_runs
from diagnosis.inference.fitting.hypothesis import Hypothesis
from diagnosis.measured.channel import SampleQuality
from diagnosis.measured.measurement import CaseKind
from diagnosis.measured.noise import noise_of_differences
from diagnosis.measured.screening import usable
from diagnosis.nominal_robot import nominal_robot
from diagnosis.nuisances import nuisances
from pipeline.diagnosing.diagnose import read_case
from pipeline.work.units import DiagnosisSettings

pytestmark = pytest.mark.recordings

MICROMOUSE = (
    *(f"batteryVoltage{number}" for number in range(1, 6)),
    *(f"encoders{number}" for number in range(1, 5)),
    *(f"testPid{number}" for number in range(1, 5)),
    *(f"wheelSpeedCalibration{number}" for number in (1, 3, 5)),
)
ROBOTINO = (
    "data_for_identification_with_integral",
    "data_for_identification_without_integral",
    "gray_0.1_175_validation",
    "green_gray_validation_data",
    "table_green_validation_data",
    "validation_data",
)


def read(path):
    return read_measurement(path, IMPORTERS)


def test_optiodom_counts_and_camera_agree_on_the_way(recordings):
    """On the straight runs, counts times the nominal wheel's circumference are the camera's way within 3 %."""
    measurement = read(recordings / "optiodom_diff" / "ivanjko" / "250620201618")
    straight = [trial for trial in measurement.trials if np.ptp(trial["theta_rad"].values) < 0.5]
    assert len(straight) >= 2
    for trial in straight:
        counts = 0.5 * (trial["enc_left_ticks"].values[-1] + trial["enc_right_ticks"].values[-1])
        way_m = counts / ENCODER_TICKS_PER_REVOLUTION * np.pi * WHEEL_DIAMETER_M
        seen_m = np.hypot(*(trial[name].values[-1] - trial[name].values[0] for name in ("x_m", "y_m")))
        assert way_m == pytest.approx(seen_m, rel=0.03)


def test_optiodom_turns_left_where_the_right_wheel_goes_further(recordings):
    measurement = read(recordings / "optiodom_diff" / "circular" / "250620202104")
    per_tick_m = np.pi * WHEEL_DIAMETER_M / ENCODER_TICKS_PER_REVOLUTION
    for trial in measurement.trials:
        turned = per_tick_m * (trial["enc_right_ticks"].values[-1] - trial["enc_left_ticks"].values[-1]) / TRACK_M
        assert turned == pytest.approx(trial["theta_rad"].values[-1], rel=0.1)


@pytest.mark.parametrize("session", ["square/230620202144", "circular/250620202104"])
def test_held_out_runs_end_no_further_off_than_by_a_calibration_of_the_trade(recordings, session, monkeypatch):
    """Least squares over whole paths for both diameters and the track, with a code of its own, on the same runs."""
    monkeypatch.syspath_prepend(str(Path(__file__).parents[3] / "benchmarks" / "diagnosis" / "recordings"))
    trade = importlib.import_module("wheel_calibrations")
    measurement = read(recordings / "optiodom_diff" / session)
    held = np.array([trial.holdout.all() for trial in measurement.trials])
    robot = nominal_robot(measurement.nominal, draw_robot(load_section("robot", "nominal"), 1, "test")[0])
    bare = Hypothesis(robot, nuisances(measurement.nominal))
    ours = WholeRuns(measurement, robot).errors(fitted_to_whole_runs(measurement, bare, bare.null(), ()).robot)[
        held, -1
    ]
    runs = [np.loadtxt(file, delimiter=",", encoding="utf-8-sig") for file in measurement.source.files]
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


@pytest.mark.parametrize("session", ["square/230620202042", "square/230620202317"])
def test_the_heading_of_a_session_is_that_of_a_calibration_of_the_trade(recordings, session, monkeypatch):
    """Least squares over whole paths with one angle of the camera's body more, with a code of its own."""
    monkeypatch.syspath_prepend(str(Path(__file__).parents[3] / "benchmarks" / "diagnosis" / "recordings"))
    trade = importlib.import_module("wheel_calibrations")
    measurement = read(recordings / "optiodom_diff" / session)
    diagnosis = diagnose(measurement)
    assert "marker_yaw" not in diagnosis.names
    heading = next(error for error in fitted_errors(diagnosis.fit) if error.effect == "marker_yaw")
    nominal = trade.Wheels(WHEEL_DIAMETER_M, WHEEL_DIAMETER_M, TRACK_M)
    runs = [np.loadtxt(file, delimiter=",", encoding="utf-8-sig") for file in measurement.source.files]
    # The trade turns the path, and a body that is turned against the path has the opposite angle.
    _, path_rad = trade.with_turned_camera(runs, nominal, ENCODER_TICKS_PER_REVOLUTION)
    assert heading.value == pytest.approx(-path_rad, abs=2.5e-3)


def test_a_set_is_read_with_the_runs_held_out_that_are_asked_for(recordings):
    measurement = read_case(recordings / "optiodom_diff", DiagnosisSettings(held_out=("circular/*", "ivanjko/*")))
    held = {trial.name.split("/")[0]: bool(trial.holdout.all()) for trial in measurement.trials}
    assert held == {"circular": True, "ivanjko": True, "square": False}
    one = read_case(
        recordings / "opatiny_micromouse" / "wheelSpeedCalibration3.csv", DiagnosisSettings(part="left wheel")
    )
    assert {trial.part for trial in one.trials} == {"left wheel"}


def test_stale_speeds_of_the_micromouse_are_marked(recordings):
    """By its description those below 15 rpm or so are stale; -24.10 rpm stands in 12 rows of the left wheel."""
    left, _ = read(recordings / "opatiny_micromouse" / "wheelSpeedCalibration5.csv").trials
    stale = left["omega_rad_s"].quality == SampleQuality.STALE
    text = (recordings / "opatiny_micromouse" / "wheelSpeedCalibration5.csv").read_text()
    assert np.count_nonzero(stale) >= text.count(" -24.10,") - 1 > 5
    assert np.abs(left["omega_rad_s"].values[stale]).max() < 30 * np.pi / 30


@pytest.mark.parametrize("name", MICROMOUSE)
def test_every_log_of_the_micromouse_is_read(recordings, name):
    path = recordings / "opatiny_micromouse" / f"{name}.csv"
    lines = path.read_text().splitlines()
    rows = sum(line.count(",") == lines[0].count(",") for line in lines[1:])
    measurement = read(path)
    assert all(len(trial.t_s) == rows for trial in measurement.trials)
    assert any("is broken" in note for note in measurement.notes) == (path.stem == "testPid4")
    assert 0.0 < measurement.trials[0].t_s[-1] < 700.0


def test_a_floor_of_the_robotino_is_24_drives_at_a_third_of_a_tenth_of_a_second(recordings):
    measurement = read(recordings / "robotino_slip" / "one_surface_type" / "brown_surface")
    assert len(measurement.trials) == 24
    assert np.median(np.diff(measurement.trials[0].t_s)) == pytest.approx(0.032, abs=0.002)
    assert measurement.trials[0]["motor_1_set_rad_s"].values[0] == pytest.approx(-34.641)


@pytest.mark.parametrize("name", ROBOTINO)
def test_every_motor_log_of_the_robotino_is_read(recordings, name):
    path = recordings / "robotino_slip" / "dc_motor_model_identification" / f"{name}.csv"
    assert read(path).rows == len(path.read_text().splitlines()) - 3


def test_the_record_of_a_sensor_at_rest_has_its_noise(recordings):
    """2 mm from one reading to the next, as the range bench finds by its Allan deviation."""
    measurement = read(recordings / "tof_vl53l0x_static" / "static_tof_dist_data_1_h.csv")
    (trial,) = measurement.trials
    noise = noise_of_differences(usable(trial["reading_m"])[:20_000])
    assert measurement.kind is CaseKind.OTHER
    assert noise.sd == pytest.approx(2.1e-3, rel=0.15)


def test_a_scan_over_an_apple_shows_light_that_falls_with_the_square(recordings):
    """Points that were held out are 4.9 mm off by beam and incidence alone."""
    (path,) = (recordings / "tof_vl53l0x_scan").glob("*.csv")
    diagnosis = diagnose(read(path))
    (named,) = diagnosis.named
    assert named.name == "range_signal_weighting"
    assert named.values["exponent"] == pytest.approx(2.0, abs=2.0 * named.std["exponent"])
    evidence = diagnosis.evidence
    predicted = evidence.predicted([diagnosis.nominal, diagnosis.extended]).mean
    before, after = np.sqrt(np.mean((evidence.values - predicted)[:, evidence.heldout] ** 2, axis=1))
    assert before > 4.5e-3
    assert after < 2.5e-3


def test_the_scan_over_an_apple_is_read(recordings):
    (path,) = (recordings / "tof_vl53l0x_scan").glob("*.csv")
    measurement = read(path)
    assert measurement.kind is CaseKind.RANGE_SCAN
    assert measurement.rows == len(path.read_text().splitlines()) - 1
    assert not measurement.trials[0].is_timed
