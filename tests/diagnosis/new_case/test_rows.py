"""Logs of any origin as measurements: units, trials, rates and what is refused."""

import math
import re
import shlex

import numpy as np
import pytest

from diagnosis.measured.measurement import CaseKind
from diagnosis.new_case.new_case import new_case
from diagnosis.new_case.proposal import propose
from diagnosis.new_case.quantities import KINDS
from diagnosis.new_case.rows import measurement_of
from logs.log_file import read_log
from logs.mapping import LogMapping, check_mapping, read_mapping
from symolo.core.errors import InputError

DRIVE = "t,encL,encR,uL,uR,x,y,theta"


@pytest.fixture
def log(tmp_path):
    """Write a log and read it."""

    def write(text):
        path = tmp_path / "run.csv"
        path.write_text(text)
        return read_log(path)

    return write


def table(header, *columns, separator=","):
    rows = zip(*columns, strict=True)
    return "\n".join([header, *(separator.join(f"{cell}" for cell in row) for row in rows)]) + "\n"


def drive(t, *, volts=None, header=DRIVE):
    """Ticks, places and heading grow steadily with the time [s], the heading by 1 rad/s."""
    ticks = np.round(200 * t).astype(int)
    volts = 2.0 + 0.0 * t if volts is None else volts
    return table(header, t, ticks, 2 * ticks, volts, -volts, 1 + 0.1 * t, 2 - 0.1 * t, np.round(t, 9))


def measured(log, mapping=None):
    return measurement_of(log, mapping or propose(log).mapping, "m")


def test_a_log_in_other_units_gives_the_same_measurement(log):
    t = 0.05 * np.arange(200)
    wrapped_deg = np.degrees(np.angle(np.exp(1j * t)))
    theirs = table(
        "time_ms;x [cm];y_mm;heading_deg;ticksLeft;ticksRight;left (mV);right (mV)",
        1.7e12 + 1e3 * t,  # since 1970
        100 * (1 + 0.1 * t),
        1000 * (2 - 0.1 * t),
        wrapped_deg,
        np.round(200 * t).astype(int),
        2 * np.round(200 * t).astype(int),
        2000 + 0 * t,
        -2000 + 0 * t,
        separator=";",
    ).replace(".", ",")
    ours, other = measured(log(drive(t))), measured(log(theirs))
    for name in ("x_m", "y_m", "theta_rad", "enc_left_ticks", "enc_right_ticks", "u_left_V", "u_right_V"):
        np.testing.assert_allclose(other.trials[0][name].values, ours.trials[0][name].values, atol=1e-8)
    np.testing.assert_allclose(other.trials[0].t_s, t, atol=1e-6)
    assert other.kind is CaseKind.DRIVE_LOG


def test_a_fast_log_is_sampled_twenty_times_a_second(log):
    t = 0.01 * np.arange(400)
    volts = np.where(np.arange(400) % 5 < 2, 1.0, 6.0)  # two of five samples have 1 V
    measurement = measured(log(drive(np.round(t, 6), volts=volts)))
    (trial,) = measurement.trials
    np.testing.assert_allclose(trial.t_s, 0.05 * np.arange(80))
    np.testing.assert_array_equal(trial["enc_left_ticks"].values, 10 * np.arange(80))
    np.testing.assert_allclose(trial["theta_rad"].values, trial.t_s)
    np.testing.assert_allclose(trial["u_left_V"].values[:-1], (2 * 1.0 + 3 * 6.0) / 5)
    sampled = "sampled again every 0.05 s; voltages are means, counts and poses are those of the row at that time"
    assert any(note.endswith(sampled) for note in measurement.notes)


def test_what_is_sampled_again_is_named_only_if_the_log_has_it(log):
    """Of rows that are by turns 0.015 s and 0.025 s apart, few are at a multiple of 0.05 s."""
    t = np.cumsum(np.tile([0.015, 0.025], 200)) - 0.015
    ticks = np.round(200 * t).astype(int)
    measurement = measured(log(table("t,encL,encR,x,y,theta", t, ticks, 2 * ticks, 0.1 * t, -0.1 * t, np.round(t, 9))))
    assert any(note.endswith("every 0.05 s; counts and poses are interpolated") for note in measurement.notes)


@pytest.mark.parametrize(
    ("rate_hz", "row_s"), [(50.0, 0.04), (40.0, 0.05), (60.0, 0.05), (30.0, 1.0 / 30.0), (70.0, 3.0 / 70.0)]
)
def test_counts_of_evenly_spaced_rows_are_those_of_whole_rows(log, rate_hz, row_s):
    """Between two rows, counts of a wheel that speeds up by a = 60 rad/s2 lie below a line, by a T^2 / 8 in the middle.

    The speed of a row would then be off by up to 0.06 rad/s; two counts are rounded to 0.006 rad/s.
    """
    ticks, rise_rad_s2 = 20_000, 60.0
    t = np.arange(240) / rate_hz
    counts = np.floor(ticks / math.tau * 0.5 * rise_rad_s2 * t**2).astype(int)
    volts, flat = 2.0 + 0.0 * t, 1.0 + 0.0 * t
    (trial,) = measured(log(table(DRIVE, np.round(t, 9), counts, counts, volts, volts, flat, flat, 0.0 * t))).trials
    np.testing.assert_allclose(np.diff(trial.t_s), row_s, rtol=1e-4)
    middle_s = 0.5 * (trial.t_s[1:] + trial.t_s[:-1])
    speeds = math.tau / ticks * np.diff(trial["enc_left_ticks"].values) / np.diff(trial.t_s)
    np.testing.assert_allclose(speeds, rise_rad_s2 * middle_s, atol=math.tau / ticks / row_s)


def test_a_log_with_uneven_rows_is_sampled_twenty_times_a_second(log):
    """Stamps that are right, as the steady counts show."""
    t = np.round(np.cumsum(np.random.default_rng(2).uniform(0.01, 0.03, 400)), 6)
    (trial,) = measured(log(drive(t))).trials
    np.testing.assert_allclose(np.diff(trial.t_s), 0.05)


@pytest.mark.parametrize(
    ("header", "change", "note"),
    [
        ("t,dticks_left,dticks_right,uL,uR", lambda counts: np.diff(counts, prepend=0), None),
        ("t,encL,encR,uL,uR", lambda counts: np.diff(counts, prepend=0), None),
        ("t,encL,encR,uL,uR", lambda counts: (counts + 60_000) % 65_536, "encL wraps at 65536 and is continued"),
    ],
)
def test_counts_are_those_that_run_on_whatever_was_logged(log, header, change, note):
    t = 0.01 * np.arange(3000)
    counts = np.floor(2000 * t + 900 * np.sin(t)).astype(int)
    volts = np.round(2.0 + 0.9 * np.cos(t), 4)
    path = log(table(header, np.round(t, 4), change(counts), change(2 * counts), volts, 2 * volts))
    measurement = measured(path)
    grown = measurement.trials[0]["enc_left_ticks"].values
    np.testing.assert_array_equal(grown - grown[0], counts[::5] - counts[0])
    assert note is None or any(note in each for each in measurement.notes)
    if note is None:
        assert any("taken for the ticks since the row before" in text for text in propose(path).warnings)


@pytest.mark.parametrize("names", ["enc1,enc2,enc3", "motor1_ticks,motor2_ticks,motor3_ticks", "encL,encR,enc_back"])
def test_three_wheels_are_refused_with_the_reason(log, names):
    path = log(f"t,{names},x,y,theta\n0,1,2,3,0,0,0\n0.05,2,3,4,0,0,0\n")
    with pytest.raises(InputError) as error:
        propose(path)
    assert f"counts of 3 wheels: {names.replace(',', ', ')}" in str(error.value)
    assert "one left and one right wheel on a common axle" in str(error.value)


def test_a_single_range_sensor_without_a_side_is_taken_for_the_one_in_front(log):
    t = 0.05 * np.arange(40)
    path = log(table("t,range_mm,x,y,theta", t, 900 + 0 * t, 1 + 0 * t, 1 + 0 * t, 0 * t))
    assert propose(path).mapping.columns["tof_front_m"].column == "range_mm"
    assert any("range_mm (tof_front_m): taken for the sensor in front" in text for text in propose(path).warnings)


def test_what_is_missing_is_named_beside_a_range_that_would_do(log):
    path = log("t,u_left,u_right,w_left,w_right,x,y,theta\n0,1,2,3,4,0,0,0\n")
    with pytest.raises(
        InputError, match=r"recognised as enc_left_ticks enc_right_ticks, or else as tof_front_m, which"
    ):
        propose(path)


def test_voltages_within_a_row_are_kept_where_they_change(log):
    t = 0.01 * np.arange(400)
    volts = np.where(np.arange(400) % 5 < 2, 1.0, 6.0)
    (trial,) = measured(log(drive(np.round(t, 6), volts=volts))).trials
    left, right = trial.held_inputs
    assert (left.name, right.name) == ("u_left_V", "u_right_V")
    np.testing.assert_allclose(left.t_s, np.sort(np.append(0.05 * np.arange(80), 0.05 * np.arange(80) + 0.02)))
    np.testing.assert_array_equal(left.values, np.tile([1.0, 6.0], 80))
    np.testing.assert_array_equal(right.values, -left.values)


def test_of_a_log_with_twenty_rows_a_second_nothing_finer_is_known(log):
    (trial,) = measured(log(drive(0.05 * np.arange(80)))).trials
    assert trial.held_inputs == ()


def test_an_irregular_log_is_sampled_again_and_its_gaps_stay_gaps(log):
    t = np.cumsum(np.tile([0.03, 0.05, 0.08], 60))
    t = t[(t < 3.0) | (t > 4.0)]
    (trial,) = measured(log(drive(np.round(t, 6)))).trials
    since = trial.t_s
    inside = (since > 3.1 - t[0]) & (since < 3.9 - t[0])
    assert np.isnan(trial["x_m"].values[inside]).all()
    known = np.isfinite(trial["x_m"].values)
    np.testing.assert_allclose(trial["x_m"].values[known], 1 + 0.1 * (since + t[0])[known], atol=1e-7)
    assert np.count_nonzero(known) > 0.8 * len(since)


@pytest.mark.parametrize("period_s", [0.01, 0.05])
@pytest.mark.parametrize("late", ["stamps", "samples"])
def test_the_counts_decide_whether_stamps_or_samples_are_late(late, period_s, log):
    rng = np.random.Generator(np.random.PCG64(8))
    even = period_s * np.arange(round(20 / period_s))
    even = even[(even < 8.0) | (even > 9.0)]  # rows that were lost
    delay = np.abs(rng.normal(0.0, 0.002, len(even)))
    stamps, sampled = even + delay, even + (delay if late == "samples" else 0.0)

    def counts(t):
        return 1900.0 * (t + 0.3 * np.sin(1.7 * t) / 1.7)

    ticks = np.floor(counts(sampled)).astype(int)
    times = np.rint(1e6 * stamps).astype(int)
    measurement = measured(log(table("time_us,encL,encR,uL,uR", times, ticks, 2 * ticks, 3 + 0 * times, 3 + 0 * times)))
    (trial,) = measurement.trials
    t_s = trial.t_s + (stamps[0] if late == "samples" else 0.0)
    next_row = np.abs(np.diff(t_s) - 0.05) < 1e-4
    grown = np.diff(trial["enc_left_ticks"].values)[next_row]
    usable = np.isfinite(grown)
    np.testing.assert_allclose(grown[usable], np.diff(counts(t_s))[next_row][usable], atol=2.5)
    assert 374 <= np.count_nonzero(usable) <= 380
    noted = [note for note in measurement.notes if "taken for evenly sampled" in note]
    assert len(noted) == (late == "stamps")


def test_a_log_that_is_too_slow_is_refused_with_the_reason(log):
    with pytest.raises(InputError, match=r"run.csv: rows are 0.2 s apart; allowed: at most 0.1 s; log at 10 Hz"):
        measured(log(drive(np.round(0.2 * np.arange(50), 6))))


def test_times_that_are_probably_in_milliseconds_are_named_with_their_unit(log):
    sources = {"t_s": "t", "enc_left_ticks": "encL", "enc_right_ticks": "encR", "x_m": "x", "y_m": "y"}
    columns = {name: {"column": column} for name, column in {**sources, "theta_rad": "theta"}.items()}
    mapping = LogMapping.model_validate({"kind": "drive_log", "columns": columns})
    with pytest.raises(InputError, match=r"rows are 20 s apart.*if the times are in ms, write unit: ms for t_s in"):
        measurement_of(log(drive(20.0 * np.arange(50))), mapping, "run")


def test_a_duty_cycle_that_a_mapping_takes_for_volts_is_named_with_its_factor(log):
    steps = np.arange(60)
    columns = {"t_s": "t", "u_left_V": "PWM L", "u_right_V": "PWM R", "enc_left_ticks": "a", "enc_right_ticks": "b"}
    mapping = LogMapping.model_validate(
        {"kind": "drive_log", "columns": {n: {"column": c} for n, c in columns.items()}}
    )
    counted = log(table("t,PWM L,PWM R,a,b", 0.05 * steps, 120 + 0 * steps, 150 + 0 * steps, 10 * steps, 12 * steps))
    with pytest.raises(InputError, match=r"column PWM L: as V it gives.*if it is a duty cycle, add .* factor: 0.029"):
        measurement_of(counted, mapping, "run")


def test_values_that_were_measured_later_than_their_row_are_moved_back(log):
    t = np.round(0.05 * np.arange(100), 6)
    sources = {"t_s": "t", "enc_left_ticks": "encL", "enc_right_ticks": "encR", "x_m": "x", "y_m": "y"}
    columns = {name: {"column": column} for name, column in sources.items()}
    columns |= {"theta_rad": {"column": "theta", "time_offset_s": 0.1, "factor": -1.0}}
    mapping = LogMapping.model_validate({"kind": "drive_log", "columns": columns})
    (trial,) = measured(log(drive(t)), mapping).trials
    # The value of the row at t was measured at t + 0.1, so at t the heading is that of two rows before.
    np.testing.assert_allclose(trial["theta_rad"].values[2:], -(t - 0.1)[2:], atol=1e-9)
    assert np.isnan(trial["theta_rad"].values[:2]).all()


def test_a_wrapped_heading_is_unwrapped_before_it_is_moved_back(log):
    t = np.round(0.05 * np.arange(400), 6)
    rows = [line.split(",") for line in drive(t).splitlines()]
    wrapped = [f"{value:.9f}" for value in np.angle(np.exp(1j * t))]
    text = "\n".join([",".join(rows[0]), *(",".join([*row[:-1], w]) for row, w in zip(rows[1:], wrapped, strict=True))])
    sources = {"t_s": "t", "enc_left_ticks": "encL", "enc_right_ticks": "encR", "x_m": "x", "y_m": "y"}
    columns = {name: {"column": column} for name, column in sources.items()}
    columns |= {"theta_rad": {"column": "theta", "time_offset_s": 0.02}}
    (trial,) = measured(log(text + "\n"), LogMapping.model_validate({"kind": "drive_log", "columns": columns})).trials
    np.testing.assert_allclose(trial["theta_rad"].values[1:], (t - 0.02)[1:], atol=1e-8)


def test_a_new_trial_begins_where_the_time_goes_back(log):
    t = 0.05 * np.arange(40)
    measurement = measured(log(drive(np.round(np.tile(t, 5), 6))))
    assert [len(trial.t_s) for trial in measurement.trials] == [40] * 5
    assert [trial.holdout.all() for trial in measurement.trials] == [False, False, False, True, False]
    begins = np.array([trial.begins_s for trial in measurement.trials], dtype=float)
    assert (np.diff(begins) > 0.0).all()


def test_a_broken_time_stamp_in_the_last_row_is_refused_with_its_row(log):
    t = np.round(0.02 * np.arange(40), 6)
    t[39] = 5e8
    with pytest.raises(InputError, match=r"run.csv: row 41: the time goes on by 5e\+08 s; .*begin a new trial"):
        measured(log(drive(t)))


def test_a_log_from_its_end_to_its_beginning_is_refused_as_by_import(log):
    t = np.round(0.02 * np.arange(40)[::-1], 6)
    with pytest.raises(InputError, match=r"run.csv: row 3: the time goes back by 0.02 s; sort the rows"):
        measured(log(drive(t)))


@pytest.mark.parametrize(("rate", "message"), [(0.1, "the robot moves at 141 m/s"), (0.0, "rows are 2e-05 s apart")])
def test_times_in_seconds_that_are_taken_for_milliseconds_are_named_with_their_unit(rate, message, log):
    """A robot that moves at 0.1 m/s in x and y; one whose poses are not logged shows the rows only."""
    t = 0.02 * np.arange(100)
    header = DRIVE.replace("t,", "time_ms,", 1)
    rows = drive(t, header=header) if rate else table(header, t, *[np.round(200 * t)] * 2, *[2 + 0 * t] * 5)
    with pytest.raises(InputError, match=rf"column time_ms: {message}.*if the times are in s, write unit: s for t_s"):
        measured(log(rows))


def test_trials_may_have_words_for_names(log):
    t = np.round(0.05 * np.arange(40), 6)
    lines = drive(t).splitlines()
    rows = [f"{line},{name}" for name in ("circle", "square") for line in lines[1:]]
    measurement = measured(log("\n".join([f"{lines[0]},run", *rows]) + "\n"))
    assert [(trial.name, len(trial.t_s)) for trial in measurement.trials] == [("1", 40), ("2", 40)]


@pytest.mark.parametrize(
    ("largest", "supply_V", "factor"),
    [(250, 8.4, 8.4 / 255), (0.9, 6.0, 6.0), (100, None, 7.4 / 100), (63.5, None, 7.4 / 100)],
)
def test_a_duty_cycle_is_a_share_of_the_supply(log, largest, supply_V, factor):
    t = np.round(0.05 * np.arange(40), 6)
    text = drive(t, volts=np.where(t > 1, 0.5, 1.0) * largest, header=DRIVE.replace("uL,uR", "pwmL,pwmR"))
    proposal = propose(log(text), supply_V=supply_V)
    assert any(re.search(r"pwmL \(u_left_V\): taken for a duty cycle", warning) for warning in proposal.warnings)
    (trial,) = measured(log(text), proposal.mapping).trials
    np.testing.assert_allclose(trial["u_left_V"].values[0], factor * largest)
    np.testing.assert_allclose(trial["u_right_V"].values[-1], -0.5 * factor * largest)


@pytest.mark.parametrize("names", ["duty_left_pct,duty_right_pct", "DutyL_pct,DutyR_pct", "motor_l [%],motor_r [%]"])
def test_a_duty_cycle_in_percent_by_its_name_is_a_share_of_the_supply(names, log):
    t = np.round(0.05 * np.arange(40), 6)
    text = log(drive(t, volts=40.0 + 0.0 * t, header=DRIVE.replace("uL,uR", names)))
    proposal = propose(text, supply_V=9.0)
    assert any("a duty cycle in percent, times 9 V" in warning for warning in proposal.warnings)
    (trial,) = measured(text, proposal.mapping).trials
    np.testing.assert_allclose(trial["u_left_V"].values, 3.6)
    np.testing.assert_allclose(trial["u_right_V"].values, -3.6)
    columns = {name: {"column": source.column} for name, source in proposal.mapping.columns.items()}
    columns["u_left_V"]["unit"] = "percent"
    mapping = LogMapping.model_validate({"kind": "drive_log", "columns": columns})
    with pytest.raises(InputError, match=r"columns\.u_left_V: .* needs the voltage of a full one; .*factor: 7\.4"):
        check_mapping(mapping, KINDS[CaseKind.DRIVE_LOG], text, "mapping.yaml")


def test_a_duty_cycle_times_the_voltage_of_the_battery_is_a_voltage(log, tmp_path):
    """40 % of a battery that falls from 8 V by 0.1 V a second; the log has percent and millivolts."""
    t = np.round(0.05 * np.arange(40), 6)
    lines = drive(t, volts=40.0 + 0.0 * t, header=DRIVE.replace("uL,uR", "pwmL,pwmR")).splitlines()
    battery = ["battery_mV", *(f"{8000 - 100 * time:.1f}" for time in t)]
    text, percent = log("\n".join(map(",".join, zip(lines, battery, strict=True))) + "\n"), {"u_left_V": "percent"}
    columns = {name: source.model_dump() for name, source in propose(text, units=percent).mapping.columns.items()}
    for side, name in (("left", "pwmL"), ("right", "pwmR")):
        columns[f"u_{side}_V"] = {"column": name, "unit": "percent", "times": "battery_mV", "factor": 0.001}
    path = tmp_path / "mapping.yaml"
    mapping = LogMapping.model_validate({"kind": "drive_log", "columns": columns})
    path.write_text(new_case(text, mapping, "m")._mapping_text(tmp_path / "case"))
    assert read_mapping(path, list(KINDS.values())) == mapping
    check_mapping(mapping, KINDS[CaseKind.DRIVE_LOG], text, str(path))
    (trial,) = measured(text, mapping).trials
    np.testing.assert_allclose(trial["u_left_V"].values, 0.4 * (8.0 - 0.1 * trial.t_s), atol=0.003)
    np.testing.assert_allclose(trial["u_right_V"].values, -0.4 * (8.0 - 0.1 * trial.t_s), atol=0.003)


@pytest.mark.parametrize(
    ("names", "largest", "suspicion"),
    [
        ("pwmL,pwmR", 3000, r"pwmL \(u_left_V\): taken for a duty .* if the values are millivolts, write unit: mV"),
        ("pwmL,pwmR", 7400, r"pwmL \(u_left_V\): taken for a duty .* if the values are millivolts, write unit: mV"),
    ],
)
def test_a_voltage_that_may_be_in_another_unit_is_named_with_that_unit(log, names, largest, suspicion):
    t = np.round(0.05 * np.arange(40), 6)
    text = drive(t, volts=np.where(t > 1, 0.5, 1.0) * largest, header=DRIVE.replace("uL,uR", names))
    assert any(re.search(suspicion, warning) for warning in propose(log(text)).warnings)


@pytest.mark.parametrize(("names", "largest"), [("pwmL,pwmR", 255), ("uL,uR", 6.0)])
def test_a_voltage_without_doubt_has_no_suspicion(log, names, largest):
    t = np.round(0.05 * np.arange(40), 6)
    text = drive(t, volts=largest + 0.0 * t, header=DRIVE.replace("uL,uR", names))
    assert "millivolt" not in " ".join(propose(log(text)).warnings)


def test_a_constant_takes_the_place_of_a_column(log):
    distances = np.repeat([0.1, 0.2, 0.3, 0.4], 3)
    readings = log(table("distance_m,tof_m", distances, distances + 0.01))
    columns = {
        "distance_m": {"column": "distance_m"},
        "reading_m": {"column": "tof_m"},
        "material": {"constant": "wood"},
        "temperature_C": {"constant": 21.5},
    }
    (trial,) = measured(readings, LogMapping.model_validate({"kind": "tof_bench", "columns": columns})).trials
    assert set(trial.label("material").values) == {"wood"}
    np.testing.assert_array_equal(trial["temperature_C"].values, 21.5)
    assert trial.holdout.tolist() == [False, False, False, True] * 3


def test_a_bench_whose_time_goes_back_is_refused_with_the_row_and_the_cure(log):
    distances = np.repeat([0.1, 0.2, 0.3, 0.4], 3)
    times = np.concatenate([np.arange(7.0), np.arange(5.0)])
    with pytest.raises(
        InputError, match=r"run.csv: row 9: the time goes back; sort the rows by time, or leave t_s out of mapping.yaml"
    ):
        measured(log(table("t [s],distance_m,tof_m", times, distances, distances + 0.01)))


def test_the_clock_of_a_bench_counts_from_switching_on_but_a_date_does_not(log):
    distances = np.repeat([0.1, 0.2, 0.3, 0.4], 3)
    for first, begins in ((62.0, 62.0), (1.7e9, 0.0)):
        times = first + 2.0 * np.arange(12)
        (trial,) = measured(log(table("t [s],distance_m,tof_m", times, distances, distances + 0.01))).trials
        np.testing.assert_allclose(trial.t_s, begins + 2.0 * np.arange(12))


@pytest.mark.parametrize(
    ("header", "scales", "units", "warnings"),
    [
        ("time,encL,encR,uL,uR,x,y,yaw", (1000, 100, 57.29578), ("ms", "cm", "degrees"), 4),
        ("time,encL,encR,uL,uR,x,y,yaw", (1e6, 1000, 1), ("us", "mm", ""), 4),
        ("t_s,encL,encR,uL,uR,x_m,y_m,theta_rad", (1, 1, 1), ("", "", ""), 0),
    ],
)
def test_units_that_no_name_states_are_guessed_from_the_values_with_a_warning(log, header, scales, units, warnings):
    t = 0.05 * np.arange(400)
    ticks = np.round(200 * t).astype(int)
    x, yaw = 1 + np.sin(t), 3 * t
    times = np.round(scales[0] * t).astype(int) if scales[0] > 1 else np.round(t, 6)
    text = table(header, times, ticks, ticks, 2 + 0 * t, 2 + 0 * t, scales[1] * x, scales[1] * x, scales[2] * yaw)
    proposal = propose(log(text))
    found = [proposal.mapping.columns[name].unit for name in ("t_s", "x_m", "theta_rad")]
    assert tuple(found) == units
    assert len(proposal.warnings) == warnings, proposal.warnings


@pytest.mark.parametrize(
    ("turn", "begin", "unit"), [(360.0, -180.0, "degrees"), (360.0, 0.0, "degrees"), (2 * math.pi, -math.pi, "")]
)
def test_a_heading_that_jumps_by_a_turn_is_in_the_unit_of_that_turn(log, turn, begin, unit):
    """At 125 degrees/s, rows are 6.25 degrees apart, which is nearly the number of radians in a turn."""
    t = 0.05 * np.arange(400)
    heading = (turn * (125 / 360) * (t + 0.1 * np.sin(t)) - begin) % turn + begin
    text = table("t_s,encL,encR,uL,uR,x_m,y_m,yaw", np.round(t, 6), *np.zeros((6, len(t))), np.round(heading, 6))
    assert propose(log(text)).mapping.columns["theta_rad"].unit == unit


def test_headings_without_a_unit_are_those_that_turn_with_the_path(log):
    """Headings of a compass from 24 to 97 degrees would be within what a robot turns if rows were a second apart."""
    t = np.arange(80.0)
    yaw = 0.6 + 0.6 * np.sin(0.1 * t)
    x, y = np.cumsum(0.03 * np.cos(yaw)) + 1, np.cumsum(0.03 * np.sin(yaw)) + 1
    for heading, unit in ((90.0 - np.degrees(yaw), "degrees"), (0.5 * math.pi - yaw, "")):
        text = table("t_s,encL,encR,uL,uR,x_m,y_m,heading", t, *np.zeros((4, len(t))), x, y, heading)
        proposal = propose(log(text))
        assert proposal.mapping.columns["theta_rad"].unit == unit
        expected = f"since the headings turn with the path in {unit or 'radians'}"
        assert any(warning.endswith(expected) for warning in proposal.warnings)


def test_a_heading_that_is_counted_clockwise_by_its_name_has_the_other_sign(log):
    t = 0.05 * np.arange(100)
    ours = measured(log(drive(t)))
    rows = [line.rsplit(",", 1) for line in drive(t, header=DRIVE.replace("theta", "yaw_cw_rad")).splitlines()]
    theirs = measured(log("\n".join([",".join(rows[0]), *(f"{row},-{yaw}" for row, yaw in rows[1:])]) + "\n"))
    np.testing.assert_allclose(theirs.trials[0]["theta_rad"].values, ours.trials[0]["theta_rad"].values, atol=1e-9)


@pytest.mark.parametrize(("largest", "unit"), [(60.0, "degrees"), (1.2, "")])
def test_an_angle_of_incidence_is_within_a_right_angle(log, largest, unit):
    """Each angle is held for several rows, so that most steps are zero."""
    angles = np.repeat(np.linspace(0.0, largest, 5), 20)
    text = table("distance_m,tof_m,angle", 0.1 + 0.001 * np.arange(100), 0.1 + 0.001 * np.arange(100), angles)
    assert propose(log(text)).mapping.columns["incidence_rad"].unit == unit


def test_a_unit_that_no_robot_could_have_is_refused_with_the_likely_one(log):
    t = np.round(0.05 * np.arange(100), 6)
    text = drive(t, header=DRIVE.replace("x,y", "x [m],y [m]")).splitlines()
    rows = [row.split(",") for row in text[1:]]
    text = "\n".join([text[0], *(",".join([*r[:5], f"{1000 * float(r[5])}", *r[6:]]) for r in rows)]) + "\n"
    with pytest.raises(InputError, match=r"column x \[m\]: as m it gives x_m around .* mm.*divide by 1000") as raised:
        measured(log(text))
    assert "mapping.yaml" in str(raised.value)


def test_all_wrong_cells_and_rows_are_reported(log):
    with pytest.raises(InputError) as raised:
        measured(log("t,encL,encR,uL,uR\n0,1,2,3,4\n0.05,a,2,3,b\n0.1,nan,,3,c\n0.15,1,2,3,4\n"))
    text = str(raised.value)
    assert len(text.splitlines()) == 3
    assert "row 3: column encL: got 'a'" in text
    assert re.search(r"row 3: column uR: got 'b'.*; rows of this column with such a cell: 2$", text, re.MULTILINE)
    with pytest.raises(
        InputError,
        match=r"row 3: 1 cells under a header of 2; .*; rows with a wrong number of cells: 2, the last one is row 4",
    ):
        log("t,x\n1,2\n3\n4\n5,6\n")
    with pytest.raises(InputError, match=r"no header.*add a line"):
        log("1,2\n3,4\n")
    with pytest.raises(InputError, match=r"column a is there twice[\s\S]*column b is there twice"):
        log("a,b,a,b\n1,2,3,4\n")


@pytest.mark.parametrize("word", ["", "nan", "NaN", "null", "None", "n/a", "-", "#N/A", "inf", "-Infinity"])
def test_a_word_for_a_missing_sample_is_a_missing_sample(word, log):
    lines = drive(np.round(0.05 * np.arange(40), 6)).splitlines()
    lines[4] = ",".join(["0.15", word, *lines[4].split(",")[2:]])
    measurement = measured(log("\n".join(lines) + "\n"))
    (trial,) = measurement.trials
    assert np.flatnonzero(np.isnan(trial["enc_left_ticks"].values)).tolist() == [3]
    assert any("1 of encL" in note for note in measurement.notes)


def test_a_last_row_that_is_cut_off_is_left_out_and_quotes_are_no_part_of_a_name(log):
    whole = drive(np.round(0.05 * np.arange(100), 6)).replace("encL", '"encL"')
    measurement = measured(log(whole + "5.0,1"))
    assert measurement.rows == 100
    assert "run.csv: the last row is cut off or has no line end, and is left out" in measurement.notes
    assert measured(log(whole[:-1])).rows == 99


@pytest.mark.parametrize("first", [0, 1])
def test_a_step_log_whose_first_row_is_still_at_rest_begins_one_row_later(first, log):
    step_s, tau_s = 0.004, 0.03
    since = step_s * np.arange(first, 80)
    rng = np.random.Generator(np.random.PCG64(4))
    volts = np.repeat([2.5, 4.5], len(since))
    speeds = volts / 0.36 * np.tile(1.0 - np.exp(-since / tau_s), 2)
    noisy = np.round(speeds + rng.normal(0.0, 0.03, len(speeds)), 4)
    clock = np.round(5.0 + np.tile(since, 2) + np.repeat([0.0, 2.0], len(since)), 6)
    measurement = measured(log(table("t [s],run,u,omega [rad/s]", clock, np.repeat([1, 2], len(since)), volts, noisy)))
    for trial, volt in zip(measurement.trials, (2.5, 4.5), strict=True):
        np.testing.assert_allclose(trial.t_s, step_s * np.arange(1, 80), atol=1e-6)
        expected = volt / 0.36 * (1.0 - np.exp(-trial.t_s / tau_s))
        np.testing.assert_allclose(trial["omega_rad_s"].values, expected, atol=0.15)
    assert any("still at rest" in note for note in measurement.notes) == (first == 0)


def test_columns_that_say_nothing_are_refused_with_what_each_kind_needs(log):
    with pytest.raises(InputError, match=r"cannot recognise what was logged.*for drive_log: enc_left_ticks") as refused:
        propose(log("foo,bar\n1,2\n"))
    assert "rpm, encL, x [mm], heading_deg, range_cm are recognised, too), or write a mapping.yaml" in str(
        refused.value
    )
    assert '`t_s: {column: "foo"}`' in str(refused.value)


def test_a_note_names_each_column_that_was_taken_by_its_unit_alone(log):
    proposal = propose(log("Zeit [s],Spannung [V],Drehzahl [1/min]\n0,1,2\n1,2,3\n"))
    note = "recognised by its unit alone; if it is something else, correct it in mapping.yaml"
    assert f"Drehzahl [1/min] (omega_rad_s): {note}" in proposal.warnings


@pytest.mark.parametrize("kind", [None, CaseKind.DRIVE_LOG])
def test_a_quantity_without_a_column_is_named_beside_the_columns_that_are_not_recognised(kind, log):
    columns = log(table("t,encL,encR,x_cm,y_cm,spin,foo", *([1, 2, 3] for _ in range(7))))
    with pytest.raises(InputError) as raised:
        propose(columns, kind)
    assert re.search(
        r"no column was recognised as theta_rad, or else as u_left_V u_right_V, which a log of the kind drive_log "
        r"needs; not recognised: spin, foo; name the column of each, such as --column theta_rad=spin; or rename "
        r"them, or write a mapping.yaml",
        str(raised.value),
    )


def test_all_faults_of_a_mapping_are_reported(log, tmp_path):
    path = tmp_path / "mapping.yaml"
    path.write_text(
        "kind: drive_log\ncolumns:\n  x_n: {column: x}\n  y_m: {column: why, unit: cm}\n"
        "  theta_rad: {column: theta, unit: mm}\n  t_s: {}\n"
    )
    with pytest.raises(InputError) as raised:
        check_mapping(
            read_mapping(path, list(KINDS.values())),
            KINDS[CaseKind.DRIVE_LOG],
            log(drive(0.05 * np.arange(10))),
            str(path),
        )
    text = str(raised.value)
    for pattern in (
        r"columns.x_n: no quantity.*did you mean x_m",
        r"columns.y_m: the log has no such column: got 'why'",
        r"columns.theta_rad: unit: got 'mm', allowed: rad, degrees",
        r"columns.t_s: give either a column or a constant",
        r"too few columns for a log of the kind drive_log",
    ):
        assert re.search(pattern, text), text
    path.write_text("columns: {t_s: {column: t}}\n")
    with pytest.raises(InputError, match=r"kind: missing; allowed: drive_log, tof_bench, motor_step, motor_steady"):
        read_mapping(path, list(KINDS.values()))
    path.write_text("kind: drive\ncolumns: {t_s: {colum: t}}\n")
    with pytest.raises(InputError, match=r"2 faults:[\s\S]*mapping.yaml:2: columns.t_s.colum: unknown key"):
        read_mapping(path, list(KINDS.values()))


@pytest.mark.parametrize(
    ("name", "source", "message"),
    [
        ("x_m", {"constant": "wood"}, r"columns.x_m: the constant is no number: got 'wood', allowed: a number"),
        ("t_s", {"constant": 3.5}, r"columns.t_s: the time cannot be constant; name the column of the times"),
        (
            "x_m",
            {"constant": 3.5, "unit": "mm"},
            r"columns.x_m: a constant takes no unit, factor, offset, times or time_offset_s",
        ),
        ("y_m", {"column": "x", "times": "y"}, r"columns.y_m: times is for voltages; allowed: u_left_V, u_right_V"),
        ("u_left_V", {"column": "uL", "times": "batt"}, r"columns.u_left_V: the log has no such column: got 'batt'"),
        ("split", {"column": "x"}, r"columns.split: no quantity that a mapping can give"),
        ("row", {"column": "x"}, r"columns.row: no quantity that a mapping can give"),
    ],
)
def test_a_source_that_cannot_be_used_is_refused(name, source, message, log):
    columns = {
        "t_s": {"column": "t"},
        "enc_left_ticks": {"column": "encL"},
        "enc_right_ticks": {"column": "encR"},
        "u_left_V": {"column": "uL"},
        "u_right_V": {"column": "uR"},
        name: source,
    }
    mapping = LogMapping.model_validate({"kind": "drive_log" if name != "row" else "tof_bench", "columns": columns})
    with pytest.raises(InputError, match=message):
        check_mapping(mapping, KINDS[CaseKind(mapping.kind)], log(drive(0.05 * np.arange(10))), "mapping.yaml")


@pytest.mark.parametrize(
    "name", ['encoder "left" #1', "enc: left", "enc\\left", "ünïts [µm] °", "{enc}", "'enc'", "null", "1e3", "🙂 left"]
)
def test_a_mapping_reads_back_as_it_was_written(name, log, tmp_path):
    columns = {
        "distance_m": {"column": name, "unit": "mm", "factor": 2.5e-7},
        "reading_m": {"column": "tof", "time_offset_s": 0.0123456789},
        "material": {"constant": "matt: 'grey' #2"},
        "temperature_C": {"constant": 1e-7},
    }
    mapping = LogMapping.model_validate({"kind": "tof_bench", "columns": columns})
    readings = log(table(f"{name},tof", [1, 2], [3, 4]))
    path = tmp_path / "mapping.yaml"
    path.write_text(new_case(readings, mapping, "m")._mapping_text(tmp_path / "my case"))
    assert read_mapping(path, list(KINDS.values())) == mapping
    check_mapping(read_mapping(path, list(KINDS.values())), KINDS[CaseKind.TOF_BENCH], readings, str(path))
    command = re.search(r"^#   (symolo case init .*)$", path.read_text(), re.MULTILINE)
    case = tmp_path / "my case"
    options = ["--mapping", str(case / "mapping.yaml"), "--out", f"{case}-2"]
    assert command is not None
    assert shlex.split(command[1]) == ["symolo", "case", "init", str(readings.path), *options]


@pytest.mark.parametrize(
    ("header", "unit"), [("distance,tof", "mm"), ("true distance,reading", "mm"), ("ref,measured", "mm")]
)
def test_both_distances_of_a_bench_in_millimetres_are_in_millimetres(header, unit, log):
    distances = np.repeat([60, 130, 260, 480], 3)  # an extent that would be few millimetres for a room
    proposal = propose(log(table(header, distances, distances + 7)))
    assert [proposal.mapping.columns[name].unit for name in ("distance_m", "reading_m")] == [unit, unit]
    assert len(proposal.warnings) == 2
    for warning in proposal.warnings:
        assert re.search(r"taken for mm, since .* up to \d+; if they are cm, correct it in mapping.yaml", warning)


def test_a_motor_s_log_is_a_step_or_a_sweep_by_the_time_between_its_rows(log):
    u = np.linspace(0, 5, 30)
    fast, slow = (table("t [s],u,omega [rad/s]", np.round(step * np.arange(30), 6), u, 3 * u) for step in (0.005, 3.0))
    assert propose(log(fast)).mapping.kind == "motor_step"
    assert propose(log(slow)).mapping.kind == "motor_steady"
    (trial,) = measured(log(fast)).trials
    np.testing.assert_allclose(trial.t_s[:2], [0.005, 0.01])  # at rest one sample before the first row
    rpm = table("u,speed [rpm]", u, 60 * u)
    (trial,) = measured(log(rpm)).trials
    assert trial.t_s[0] > 1e5  # without times, nothing may look like warming up
    np.testing.assert_allclose(trial["omega_rad_s"].values, 2 * math.pi * u, atol=1e-8)


@pytest.mark.parametrize(
    ("at_s", "at_ticks", "held_from_s"),
    [([1.0, 2.0], [0, 200], 1.8), ([1.0, 1.5, 2.5], [0, 148, 200], 1.55), ([1.0, 4.0], [0, 600], 3.0)],
    ids=["even", "fast and then slow", "to the end"],
)
def test_rows_in_which_something_moves_are_held_out(log, at_s, at_ticks, held_from_s):
    """The last quarter of the time says nothing if the robot stands still there: then that of the ticks is held out."""
    t = 0.05 * np.arange(80)
    ticks = np.round(np.interp(t, at_s, at_ticks)).astype(int)
    measurement = measured(log(table("t,encL,encR,uL,uR", np.round(t, 2), ticks, ticks, 2 + 0 * t, 2 + 0 * t)))
    (trial,) = measurement.trials
    np.testing.assert_array_equal(trial.holdout, trial.t_s > held_from_s - 0.02)
    assert any("where nothing moves in it" in note for note in measurement.notes) == (held_from_s < 3.0)


@pytest.mark.parametrize(
    ("unit", "suspicion"),
    [("cm", r"is the column in mm\? then write unit: mm for distance_m in mapping.yaml; otherwise, "), ("mm", "")],
)
def test_an_input_out_of_reach_is_named_with_its_row_in_the_log(unit, suspicion, log):
    true = np.array([50, 300, 600, 900, 1200])
    if unit == "mm":
        true[4] = 12000
    columns = {"distance_m": {"column": "true", "unit": unit}, "reading_m": {"column": "read", "unit": "mm"}}
    mapping = LogMapping.model_validate({"kind": "tof_bench", "columns": columns})
    written = log(table("true,read", true, true))
    message = rf"row 6: column true: as {unit} it gives distance_m 12; allowed: 0 to 10 m; {suspicion}repair or remove"
    with pytest.raises(InputError, match=message):
        measurement_of(written, mapping, "run")


def test_a_number_that_is_too_large_in_our_unit_is_refused_with_its_row(log):
    """1e308 cm, a billion times, are more metres than a number of 64 bits holds."""
    text = drive(np.arange(0, 3, 0.05)).splitlines()
    text[3] = ",".join("1e308" if place == 5 else cell for place, cell in enumerate(text[3].split(",")))
    table = log("\n".join(text) + "\n")
    mapping = propose(table).mapping
    far = mapping.columns["x_m"].model_copy(update={"unit": "cm", "factor": 1e9})
    with pytest.raises(InputError, match=r"run\.csv: row 4: column x: too large: got '1e308'"):
        measured(table, mapping.model_copy(update={"columns": {**mapping.columns, "x_m": far}}))
