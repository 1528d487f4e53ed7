"""Importers of other people's logs, on files of their forms written by hand."""

import re
from pathlib import Path

import numpy as np
import pytest

from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from diagnosis.importers.robotino import FORMS
from diagnosis.measured.channel import SampleQuality
from diagnosis.measured.measurement import CaseKind
from diagnosis.measured.overview import overview
from symolo.core.errors import InputError


def read(path, name=None):
    return read_measurement(path, IMPORTERS, name)


def refusal(path, name=None):
    with pytest.raises(InputError) as raised:
        read(path, name)
    return str(raised.value)


@pytest.fixture
def session(tmp_path):
    folder = tmp_path / "circular" / "250620202104"
    folder.mkdir(parents=True)
    (folder / "250620202104_metadata.csv").write_text("type,diff,,\nLi,0.205,,\nDi,0.084,0.084,\nN,2,,\n")
    (folder / "250620202104_run-01_odo.csv").write_text("\ufeff540.65,0,0\n")
    for run, turn in (("01", 3), ("02", -3)):
        rows = [f"{0.05 * k},{0.001 * k},0,{0.01 * k},{5 + turn},{5}" for k in range(12)]
        (folder / f"250620202104_run-{run}.csv").write_text("\n".join(rows) + "\n")
    return folder


def test_counts_of_optiodom_add_up_and_belong_to_their_side(session):
    measurement = read(session)
    assert (measurement.kind, [trial.name for trial in measurement.trials]) == (
        CaseKind.DRIVE_LOG,
        ["circular/250620202104_run-01", "circular/250620202104_run-02"],
    )
    first, second = measurement.trials
    assert first["enc_left_ticks"].values[-1] == 12 * 5
    assert (first["enc_right_ticks"].values[-1], second["enc_right_ticks"].values[-1]) == (12 * 8, 12 * 2)
    assert (first["x_m"].clock, first["enc_left_ticks"].clock) == ("camera", "log")
    assert any("driven with a wheel separation of 0.205 m" in note for note in measurement.notes)


def test_optiodom_knows_its_wheels_as_they_were_drawn(session):
    """84 mm and 200 mm by its description, whatever the controller ran with; gears times counts of the motor."""
    robot = read(session).nominal.robot
    assert (robot.wheel_radius_m.value, robot.wheel_separation_m.value) == (0.042, 0.2)
    assert robot.encoder_ticks_per_revolution == pytest.approx(2796.8)
    assert robot.wheel_radius_m.tolerance < 0.001


def test_every_third_run_of_an_optiodom_session_is_held_out(session):
    text = (session / "250620202104_run-01.csv").read_text()
    for run in ("03", "04", "05", "06"):
        (session / f"250620202104_run-{run}.csv").write_text(text)
    measurement = read(session)
    assert [t.name[-2:] for t in measurement.trials if t.holdout.all()] == ["03", "06"]
    assert sum(t.holdout.any() for t in measurement.trials) == 2
    assert "every third run of a session is held out" in measurement.notes
    assert read(session / "250620202104_run-03.csv").heldout_rows == 0


def test_optiodom_is_known_from_a_run_a_session_and_the_folder_above(session):
    assert len(read(session / "250620202104_run-02.csv").trials) == 1
    assert len(read(session.parent).trials) == len(read(session.parent.parent).trials) == 2


def test_a_session_whose_lengths_nobody_noted_is_refused(session):
    (session / "250620202104_metadata.csv").write_text("type,diff\n")
    assert "there is no row Li" in refusal(session)


def test_a_bad_run_of_optiodom_names_row_and_column(session):
    path = session / "250620202104_run-01.csv"
    path.write_text(path.read_text().replace("0.002,0,0.02", "0.002,x,0.02"))
    assert re.search(r"run-01.csv: row 3: column y_m: got 'x'", refusal(session))


STEADY = "time, batteryVoltage, motorCommand, leftSpeedRpm, rightSpeedRpm\n"


def test_steady_speeds_of_the_micromouse_are_by_wheel_in_rad_s_and_volts(tmp_path):
    path = tmp_path / "wheelSpeedCalibration3.csv"
    path.write_text(STEADY + "1000, 7500, 51, 60.00, 30.00\n2100, 7400, 102, 120.00, 66.00\n")
    left, right = read(path).trials
    np.testing.assert_allclose(left["u_cmd_V"].values, [7.5 * 0.2, 7.4 * 0.4])
    np.testing.assert_allclose(left["omega_rad_s"].values, [2 * np.pi, 4 * np.pi])
    np.testing.assert_allclose(right["omega_rad_s"].values, [np.pi, 2.2 * np.pi])
    np.testing.assert_allclose(left.t_s, [0.0, 1.1])


def test_the_motor_of_the_micromouse_is_that_of_its_maker(tmp_path):
    """12 V and 0.75 A stalled are 16 ohm; idling, 80 mA leave 10.72 V at 1100 rpm; friction is K times 80 mA there."""
    path = tmp_path / "wheelSpeedCalibration3.csv"
    path.write_text(STEADY + "".join(f"{1000 * k}, 7500, 51, 60.00, 30.00\n" for k in range(1, 9)))
    measurement = read(path)
    motor = measurement.nominal.motor
    idling = 1100 * np.pi / 30
    assert motor.winding_resistance_ohm.value == 16.0
    assert motor.torque_constant_N_m_A.value == pytest.approx(10.72 / idling)
    friction = motor.coulomb_friction_N_m.value + motor.viscous_friction_N_m_s_rad.value * idling
    assert friction == pytest.approx(10.72 / idling * 0.08)
    for trial in measurement.trials:
        np.testing.assert_array_equal(trial.holdout, [False, False, False, True] * 2)


def test_speeds_said_again_and_again_are_stale_in_later_sets_alone(tmp_path):
    rows = [f"{k}.0, 7500, {5 * k - 20}, {-24.1 if k < 5 else 0.0}, {k}.5" for k in range(8)]
    for number, stale in ((5, [False, True, True, True, True, False, False, False]), (3, [False] * 8)):
        path = tmp_path / f"wheelSpeedCalibration{number}.csv"
        path.write_text(STEADY + "\n".join(rows) + "\n")
        left, _ = read(path).trials
        np.testing.assert_array_equal(left["omega_rad_s"].quality == SampleQuality.STALE, stale)
        assert left.t_s[-1] == 7.0


def test_a_log_without_battery_has_no_voltage(tmp_path):
    path = tmp_path / "wheelSpeedCalibration1.csv"
    path.write_text("time, motorCommand, leftSpeedRpm, rightSpeedRpm\n42300, 0, 0.0, 0.0\n43399, 51, 1.0, 2.0\n")
    left, _ = read(path).trials
    assert not left["u_cmd_V"].is_offered
    np.testing.assert_allclose(left["duty"].values, [0.0, 0.2])


def test_a_log_of_the_controller_keeps_target_speed_and_duty(tmp_path):
    path = tmp_path / "testPid2.csv"
    path.write_text(
        "time, targetSpeed, leftSpeed, leftCommand, rightSpeed, rightCommand\n"
        "219.202, 300, 0.00, 51, 30.00, 255\n219.212, 300, 60.00, 12, 0.00, 12\n"
    )
    (trial,) = read(path).trials
    np.testing.assert_allclose(trial["omega_left_rad_s"].values, [0.0, 2 * np.pi])
    np.testing.assert_allclose(trial["duty_right"].values, [1.0, 12 / 255])
    np.testing.assert_allclose(trial.t_s, [0.0, 0.01], atol=1e-9)


def test_a_log_of_another_name_is_read_where_its_form_is_named(tmp_path):
    path = tmp_path / "mine.csv"
    path.write_text(STEADY + "1000, 7500, 51, 60.00, 30.00\n")
    assert "is none of these logs" in refusal(path, "micromouse")
    assert "is not measured data of a known form" in refusal(path)


ROBOTINO = (
    "Time;1st set;2nd set;3rd set;1st pos;2nd pos;3rd pos;1st v;2nd v;3rd v;1st I;2nd I;3rd I;\n"
    "ms;rad/s;rad/s;rad/s;ticks;ticks;ticks;rad/s;rad/s;rad/s;A;A;A;\n"
    "t;m1setvel;m2setvel;m3setvel;m1pos;m2pos;m3pos;m1vel;m2vel;m3vel;m1cur;m2cur;m3cur;\n"
)


def test_three_header_rows_and_milliseconds_of_the_robotino(tmp_path):
    path = tmp_path / "validation.csv"
    path.write_text(ROBOTINO + "0.5;100;0;-100;0;0;0;1;2;3;0.1;0.2;0.3;\n30.5;100;0;-100;5;6;7;1;2;3;0.1;0.2;0.3;\n")
    (trial,) = read(path).trials
    np.testing.assert_allclose(trial.t_s, [0.0005, 0.0305])
    np.testing.assert_array_equal(trial["motor_3_A"].values, [0.3, 0.3])
    np.testing.assert_array_equal(trial["motor_1_set_rad_s"].values, [100, 100])


def test_an_angle_of_the_robotino_that_is_missing_leaves_the_others(tmp_path):
    """170, 178, none, -166, -158 degrees: a steady turn of 8 a row, over half a turn and a hole."""
    symbols = {"t": "ms", **{column.name: column.unit for column in FORMS[-1]}}
    rows = [
        ";".join(str(32 * k) if symbol == "t" else angle if symbol == "ang" else "0" for symbol in symbols)
        for k, angle in enumerate(("170", "178", "", "-166", "-158"))
    ]
    path = tmp_path / "tracked.csv"
    names = ";".join("Time" if symbol == "t" else symbol for symbol in symbols)
    path.write_text("\n".join([names, ";".join(symbols.values()), ";".join(symbols), *rows]) + "\n")
    theta = read(path).trials[0]["theta_rad"]
    np.testing.assert_allclose(theta.values, np.radians([170, 178, np.nan, 194, 202]))


def test_another_unit_of_the_robotino_is_refused(tmp_path):
    path = tmp_path / "validation.csv"
    path.write_text(ROBOTINO.replace("A;A;A;", "A;mA;A;") + "0.5;100;0;-100;0;0;0;1;2;3;0.1;0.2;0.3;\n")
    assert re.search("row 2: unit of column m2cur: got 'mA', allowed: A", refusal(path))


def test_the_tables_of_the_paper_are_measurements():
    """Corners of the printed tables, typed in once more."""
    (motor,) = read_table("table-1").trials
    assert (motor["u_cmd_V"].values[-1], motor["current_A"].values[-1], motor["omega_rad_s"].values[-1]) == (
        5.0,
        0.17868,
        14.318,
    )
    assert motor["omega_rad_s"].values[1] == 0.0
    (tones,) = read_table("table-3").trials
    assert tones.label("material").values[-1] == "black_board"
    assert tones["reading_m"].values[-1] == pytest.approx(0.09563)
    (materials,) = read_table("table-4").trials
    assert dict(zip(materials.label("material").values, materials["reading_m"].noise_sd, strict=True))[
        "glass"
    ] == pytest.approx(1.77e-3)
    assert not materials.is_timed


def read_table(name):
    return read(Path(name))


def test_a_misspelt_table_names_the_nearest(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert "did you mean table-3" in refusal(Path("tabel-3"))


def test_an_importer_that_is_not_there_names_the_nearest(tmp_path):
    assert re.search("--importer: got 'optiodm'.*did you mean optiodom", refusal(tmp_path, "optiodm"))


def test_the_overview_of_a_session_states_rate_gaps_and_channels(session):
    lines = overview(read(session))
    assert lines[0] == "250620202104: drive_log, 2 trials, 24 rows (none held out)"
    assert any(re.match(r"circular/250620202104_run-01 +12 +0 +- +0.55 +20 +0 +0.05", line) for line in lines)
    assert any(re.match(r"enc_right_ticks +ticks +reading +24 +- +- +- +- +2 +96 ", line) for line in lines)
