"""Inputs of unseen runs: what is read of them, all of it held out."""

import re

import numpy as np
import pytest

from diagnosis.importers.cases.blind import read_blind
from diagnosis.measured.channel import SampleQuality
from diagnosis.measured.measurement import CaseKind
from symolo.core.errors import InputError

POSE = (
    "session_time_s,t_s,enc_left_ticks,enc_right_ticks,x_m,y_m,theta_rad\n"
    "105.00,0.00,0,0,0.995,0.84,0.2946\n105.05,0.05,18,-19,,,\n"
)


def test_the_pose_of_an_unseen_drive_is_that_of_its_first_row(tmp_path):
    (tmp_path / "blind_pose_inputs.csv").write_text(POSE)
    measurement = read_blind(tmp_path, CaseKind.DRIVE_LOG)
    assert list(measurement) == ["blind_pose_inputs.csv"]
    (trial,) = measurement["blind_pose_inputs.csv"].trials
    assert trial.holdout.all()
    assert trial.begins_s == 105.0
    np.testing.assert_array_equal(trial["x_m"].quality, [SampleQuality.GOOD, SampleQuality.MISSING])
    np.testing.assert_array_equal(trial["enc_right_ticks"].values, [0, -19])


def test_unseen_rows_of_a_range_bench_have_materials_and_no_reading(tmp_path):
    header = "row,t_s,distance_m,material,incidence_rad,temperature_C,ambient_lux\n"
    (tmp_path / "blind_inputs.csv").write_text(header + "1,800.0,0.52,wood,0.0,14.5,968\n")
    (trial,) = read_blind(tmp_path, CaseKind.TOF_BENCH)["blind_inputs.csv"].trials
    assert trial.label("material").values == ("wood",)
    with pytest.raises(KeyError, match="no channel 'reading_m'"):
        trial["reading_m"]


def test_an_unseen_run_with_readings_is_none(tmp_path):
    (tmp_path / "blind_inputs.csv").write_text("row,t_s,u_cmd_V,current_A\n1,504.0,3.614,0.1\n")
    with pytest.raises(InputError) as raised:
        read_blind(tmp_path, CaseKind.MOTOR_STEADY)
    assert re.search("blind_inputs.csv: row 1: column current_A is not known", str(raised.value))


def test_a_case_without_unseen_runs_has_none(tmp_path):
    assert read_blind(tmp_path, CaseKind.MOTOR_STEP) == {}
