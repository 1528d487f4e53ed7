"""The four kinds of measured case: content of good ones, and messages for bad ones."""

import re

import numpy as np
import pytest
import yaml

from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from diagnosis.measured.case_files.write_case import csv_of, write_case
from diagnosis.measured.channel import Role, SampleQuality
from diagnosis.measured.measurement import CaseKind
from diagnosis.measured.overview import overview
from symolo.core.errors import InputError
from symolo.core.yaml import reader

TIMES_S = [0.005 * step for step in range(60)]
KINDS = ("motor_steady", "motor_step", "tof_bench", "drive_log")
GOOD, MISSING, NO_TARGET = SampleQuality.GOOD, SampleQuality.MISSING, SampleQuality.NO_TARGET


def read(path):
    return read_measurement(path, IMPORTERS)


def refusal(path):
    with pytest.raises(InputError) as raised:
        read(path)
    return str(raised.value)


@pytest.mark.parametrize("kind", KINDS)
def test_a_case_is_recognised_by_its_nominal_file(case, kind):
    measurement = read(case(kind))
    assert (measurement.kind, measurement.name) == (CaseKind(kind), kind)
    assert measurement.nominal.kind == kind


@pytest.mark.parametrize("kind", KINDS)
def test_a_case_is_found_by_either_of_its_files_too(case, kind):
    folder = case(kind)
    assert read(folder / "data.csv").rows == read(folder / "nominal.yaml").rows == read(folder).rows


def test_sweeps_are_trials_whose_time_counts_on(case):
    up, down = read(case("motor_steady")).trials
    assert (up.name, down.name) == ("1", "2")
    np.testing.assert_array_equal(down.t_s, [9.0, 12.0])
    assert up.begins_s == down.begins_s == 0.0
    np.testing.assert_array_equal(up.holdout, [False, False, True])
    np.testing.assert_array_equal(down["omega_rad_s"].quality, [MISSING, GOOD])
    np.testing.assert_array_equal(up["current_A"].noise_sd, [0.001] * 3)
    assert (up["u_cmd_V"].role, up["u_cmd_V"].unit, up["u_cmd_V"].noise_sd) == (Role.INPUT, "V", None)


def test_trials_of_steps_keep_their_place_in_the_session(case):
    first, second = read(case("motor_step")).trials
    assert (first.begins_s, second.begins_s) == (0.0, pytest.approx(2.0))
    assert second.holdout.all()
    assert not first.holdout.any()
    assert np.isnan(first["current_A"].values[2])
    assert first["omega_rad_s"].noise_correlation == 0.3


def test_noise_of_a_range_is_the_polynomial_at_its_distance(case):
    (trial,) = read(case("tof_bench")).trials
    beyond = 0.54 - 0.18
    by_hand_m = 1e-3 * (1.4 + 4.88 * beyond + 2.51 * beyond**2 + 1.15 * beyond**3)
    np.testing.assert_allclose(trial["reading_m"].noise_sd[[1, 2]], [1.4e-3, by_hand_m])
    np.testing.assert_array_equal(trial["reading_m"].quality, [GOOD, MISSING, NO_TARGET])
    assert trial["reading_m"].values[2] == 8.19
    assert trial.label("material").values == ("wood", "plastic", "wood")


def test_what_a_drive_did_not_see_or_log_is_marked_and_not_filled_in(case):
    first, _ = read(case("drive_log")).trials
    np.testing.assert_array_equal(first["tof_left_m"].quality, [MISSING, NO_TARGET, NO_TARGET])
    np.testing.assert_array_equal(first["u_left_V"].quality, [GOOD, GOOD, MISSING])
    np.testing.assert_array_equal(first["y_m"].quality, [GOOD, GOOD, MISSING])
    np.testing.assert_array_equal(first["enc_right_ticks"].values, [0, 5, 11])
    assert {name: first[name].clock for name in ("x_m", "theta_rad", "enc_left_ticks")} == {
        "x_m": "camera",
        "theta_rad": "camera",
        "enc_left_ticks": "log",
    }


def test_channels_that_were_never_logged_are_named(case, text):
    lines = text("drive_log").splitlines()
    cells = [line.split(",") for line in lines[1:]]
    data = "\n".join([lines[0], *(",".join([*row[:6], "", "", *row[8:]]) for row in cells)]) + "\n"
    measurement = read(case("drive_log", data=data))
    assert "not logged: u_left_V, u_right_V" in measurement.notes
    assert not measurement.trials[0]["u_left_V"].is_offered


@pytest.mark.parametrize("kind", KINDS)
def test_a_case_comes_back_from_what_was_written(case, kind, tmp_path):
    measurement = read(case(kind))
    write_case(measurement, tmp_path / "again" / kind)
    again = read(tmp_path / "again" / kind)
    assert again.nominal == measurement.nominal
    assert csv_of(again) == csv_of(measurement)
    for before, after in zip(measurement.trials, again.trials, strict=True):
        assert (before.name, before.begins_s, before.labels) == (after.name, after.begins_s, after.labels)
        np.testing.assert_array_equal(before.holdout, after.holdout)
        for channel in before.channels:
            np.testing.assert_array_equal(channel.values, after[channel.name].values)
            np.testing.assert_array_equal(channel.quality, after[channel.name].quality)


def test_columns_may_stand_in_any_order(case, text):
    rows = [line.split(",") for line in text("motor_step").splitlines()]
    turned = "\n".join(",".join(row[::-1]) for row in rows) + "\n"
    assert csv_of(read(case("motor_step", data=turned))) == csv_of(read(case("motor_step")))


def changed(row, column, value):
    """The text of motor_step's data.csv with one cell replaced, rows and columns from 1."""

    def change(text):
        lines = [line.split(",") for line in text.splitlines()]
        lines[row - 1][column - 1] = value
        return "\n".join(map(",".join, lines)) + "\n"

    return change


BAD_STEPS = {
    "misspelt column": (
        changed(1, 6, "curent_A"),
        "row 1: column curent_A is not known.*did you mean current_A.*rename",
    ),
    "column in another unit": (changed(1, 6, "current_mA"), "row 1: column current_mA.*convert it to A and rename"),
    "column twice": (changed(1, 6, "omega_rad_s"), "row 1: column omega_rad_s is there twice"),
    "column too many": (
        lambda text: (
            "\n".join(f"{line},1" if i else f"{line},extra" for i, line in enumerate(text.splitlines())) + "\n"
        ),
        "row 1: column extra is not known.*remove it",
    ),
    "column missing": (
        lambda text: "\n".join(line.partition(",")[2] for line in text.splitlines()) + "\n",
        "row 1: column trial is missing.*add it",
    ),
    "no header": (lambda text: text.partition("\n")[2].replace("fit", "0").replace("holdout", "1"), "row 1: no header"),
    "semicolons": (lambda text: text.replace(",", ";"), "row 1: one column.*commas, not with ';'"),
    "nan": (changed(3, 6, "nan"), "row 3: column current_A: got 'nan'.*leave the cell empty"),
    "inf": (changed(3, 7, "-inf"), "row 3: column omega_rad_s: got '-inf'"),
    "null": (changed(4, 7, "null"), "row 4: column omega_rad_s: got 'null'.*leave the cell empty"),
    "word": (changed(2, 5, "full"), "row 2: column u_cmd_V: got 'full'"),
    "underscore": (changed(2, 5, "1_0"), "row 2: column u_cmd_V: got '1_0'"),
    "decimal comma": (changed(3, 6, "0,98"), "row 3: 8 columns; allowed: 7.*decimals take a point"),
    "input missing": (changed(3, 5, ""), "row 3: column u_cmd_V: got ''"),
    "time missing": (changed(3, 4, ""), "row 3: column t_s: got ''"),
    "unknown split": (changed(3, 2, "held"), "row 3: column split: got 'held'.*fit, holdout"),
    "trial is no number": (changed(3, 1, "1.5"), "row 3: column trial: got '1.5'.*whole number"),
    "trial comes again": (changed(3, 1, "2"), "row 4: column trial: 1 appears again.*sort"),
    "time repeats": (changed(3, 4, "0.005"), "row 3: column t_s: 0.005 repeats 0.005 of the row above"),
    "time goes back": (changed(4, 4, "0.007"), "row 4: column t_s: 0.007 goes back from 0.01 of the row above"),
    "session goes back": (changed(5, 3, "0.001"), "row 5: column session_time_s"),
    "row cut off": (lambda text: text[: text.rindex(",")], "row 6: 6 columns; allowed: 7.*cut off"),
    "blank row": (lambda text: text.replace("1,fit,0.010", "\n1,fit,0.010"), "row 3: 1 column; allowed: 7"),
    "empty file": (lambda _: "", "data.csv: is empty"),
    "header alone": (lambda text: text.partition("\n")[0] + "\n", "has no rows below the header"),
    "header of a column of words alone": (lambda _: "split", "has no rows below the header"),
    "no text": (lambda _: b"\xff\xfa\x00\n", "row 1: is no UTF-8 text"),
    "UTF-16": (lambda text: text.encode("utf-16"), "is UTF-16 text; save it as UTF-8"),
    "old line ends": (lambda text: text.replace("\n", "\r"), "row 1: a carriage return within the row"),
    "NUL bytes": (changed(3, 6, "0.9\x00"), "row 3: column current_A"),
    "times in ms": (
        lambda text: re.sub(r"(?<=fit,)([0-9.]+),([0-9.]+)", lambda m: f"{m[1]},{1000 * float(m[2]):g}", text),
        "column t_s: rows are 5 s apart.*divide by 1000",
    ),
    "trial that begins late": (
        lambda text: re.sub(r"(?<=2,holdout,)2.0(..),0.0", r"102.0\1,100.0", text),
        "row 5: column t_s: trial 2 begins at 100.005 s.*starts at rest at t_s = 0",
    ),
    "trial that begins before rest": (
        lambda text: text.replace("1,fit,0.005,0.005", "1,fit,-5,-5"),
        "row 2: column t_s: trial 1 begins at -5 s.*starts at rest at t_s = 0",
    ),
    "session in ms": (
        lambda text: re.sub(r"(?<=fit,)([0-9.]+)|(?<=holdout,)([0-9.]+)", lambda m: f"{1000 * float(m[0]):g}", text),
        "row 3: column session_time_s.*this looks like ms: divide by 1000",
    ),
    "session that jumps within a trial": (
        changed(4, 3, "0.9"),
        "row 4: column session_time_s: goes 0.89 s on from the row above, and t_s 0.01 s",
    ),
    "voltages in mV": (
        lambda text: text.replace(",3.0,", ",3000,").replace(",-3.0,", ",-3000,"),
        "column u_cmd_V: most values are out of.*looks like mV: divide by 1000; or like a duty cycle: multiply by the",
    ),
    "voltages in mV between pauses": (
        lambda text: (
            "\n".join(
                [text.splitlines()[0]]
                + [f"1,fit,{t:g},{t:g},{-2130 if 30 <= k < 40 else 0},0.1,0.5" for k, t in enumerate(TIMES_S)]
                + [f"2,holdout,{2 + t:g},{t:g},0,0.1,0.5" for t in TIMES_S]
            )
            + "\n"
        ),
        "column u_cmd_V: most values are out of scale, typically 2130; .*this looks like mV",
    ),
    "one voltage out of reach": (changed(3, 5, "300"), "row 3: column u_cmd_V: got 300.*allowed: -60 to 60 V"),
}


@pytest.mark.parametrize("fault", BAD_STEPS)
def test_a_bad_log_is_refused_with_file_row_and_column(case, text, fault):
    spoil, pattern = BAD_STEPS[fault]
    message = refusal(case("motor_step", data=spoil(text("motor_step"))))
    assert "data.csv" in message
    assert re.search(pattern, message), message


def test_all_faults_of_a_case_are_reported_at_once(case, text):
    """One of each kind, in both files: keys, columns, cells. A misspelt key is not reported as missing, too."""
    nominal = (case("drive_log") / "nominal.yaml").read_text()
    spoilt = nominal.replace("{value: 0.16,", "{value: -0.16,").replace("room_y_m: 1.6", "room_y: 1.6")
    data = text("drive_log").replace("tof_left_m", "tof_left").replace(",1.0004,", ",one,").replace("2,hold", "x,hold")
    lines = refusal(case("drive_log", nominal=spoilt, data=data)).splitlines()
    patterns = (
        r"nominal.yaml:\d+: world.room_y: unknown key.*did you mean room_y_m",
        r"nominal.yaml:\d+: robot.wheel_separation_m.value: got -0.16, allowed: ",
        r"data.csv: row 1: column tof_left is not known.*rename",
        r"data.csv: row 3: column x_m: got 'one'.*so do 1 more rows, the last one row 6",
        r"data.csv: row 5: column trial: got 'x'.*so do 1 more rows, the last one row 6",
    )
    assert lines[0] == f"{len(patterns)} faults:"
    assert len(lines) == len(patterns) + 1
    for pattern in patterns:
        assert any(re.search(pattern, line) for line in lines), f"{pattern} in {lines}"


def test_all_columns_in_other_units_are_reported_at_once(case, text):
    rows = [line.split(",") for line in text("drive_log").splitlines()]
    for row in rows[1:]:
        row[13], row[14] = ("100.1" if row[13] else ""), ("80.2" if row[14] else "")
        row[10] = "900"
    message = refusal(case("drive_log", data="\n".join(map(",".join, rows)) + "\n"))
    for column, unit in (("x_m", "cm"), ("y_m", "cm"), ("tof_front_m", "mm")):
        assert re.search(rf"column {column}: most values are out of scale.*{unit}.*divide by", message), message


def test_a_column_that_was_not_logged_may_be_left_out(case, text):
    header, *rows = [line.split(",") for line in text("drive_log").splitlines()]
    emptied = [header, *([*row[:6], "", "", *row[8:]] for row in rows)]
    shorter = [[*row[:6], *row[8:]] for row in (header, *rows)]
    whole, lacking = (
        read(case("drive_log", data="\n".join(map(",".join, table)) + "\n")) for table in (emptied, shorter)
    )
    assert csv_of(lacking) == csv_of(whole)
    assert lacking.notes == whole.notes == ("not logged: u_left_V, u_right_V",)


def test_a_huge_file_is_refused_before_it_is_read(case, monkeypatch):
    monkeypatch.setattr("symolo.core.files.text_file.MAX_BYTES", 100)
    assert re.search(r"data.csv: is too large.*split it", refusal(case("motor_step")))


@pytest.mark.parametrize("column", ["distance_m", "reading_m"])
def test_millimetres_under_a_header_in_metres_are_refused(case, text, column):
    names = text("tof_bench").splitlines()[0].split(",")
    rows = [line.split(",") for line in text("tof_bench").splitlines()[1:]]
    for row in rows:
        cell = row[names.index(column)]
        row[names.index(column)] = f"{1000 * float(cell):g}" if cell else ""
    message = refusal(case("tof_bench", data="\n".join(map(",".join, [names, *rows])) + "\n"))
    assert re.search(rf"column {column}: most values are out of scale.*mm.*: divide by 1000", message)


def test_a_wild_reading_is_no_wrong_unit(case, text):
    measurement = read(case("tof_bench", data=text("tof_bench").replace("902,0.321", "902,4321")))
    assert measurement.trials[0]["reading_m"].values[0] == 4321


def test_speeds_in_rpm_are_recognised_by_what_the_motor_can_do(case):
    rows = [f"{i},1,fit,{i}.0,{u},0.08,{u / 0.3 * 30 / np.pi:.3f}" for i, u in enumerate((2.0, 3.0, 4.0, 5.0), 1)]
    data = "\n".join(["row,sweep,split,t_s,u_cmd_V,current_A,omega_rad_s", *rows]) + "\n"
    (note,) = read(case("motor_steady", data=data)).notes
    assert re.search("CHECK THE UNIT of omega_rad_s.*9.55 times.*rpm: divide by 9.549", note)


def test_degrees_under_a_header_in_radians_are_recognised_by_what_the_wheels_did(case, text):
    """Turning on the spot: opposite counts, of which 1920 are a turn of a wheel of 30 mm at 80 mm from the middle."""
    per_tick_deg = np.degrees(2 * 2 * np.pi * 0.03 / 1920 / 0.16)
    rows = [
        f"1,fit,{t:.2f},{t:.2f},,,,,{-n},{n},,,,1.0,0.8,{n * per_tick_deg:.4f}"
        for n in range(0, 800, 20)
        for t in [n / 400]
    ]
    data = "\n".join([text("drive_log").splitlines()[0], *rows]) + "\n"
    notes = read(case("drive_log", data=data)).notes
    assert any(re.search("CHECK THE UNIT of theta_rad.*57.3 times.*degrees", note) for note in notes)


def test_an_unknown_material_names_its_row_and_the_nearest(case, text):
    message = refusal(case("tof_bench", data=text("tof_bench").replace("plastic", "plastik")))
    assert re.search("row 3: column material: got 'plastik'.*did you mean plastic", message)


def test_a_byte_order_mark_and_windows_line_ends_are_read(case, text):
    data = b"\xef\xbb\xbf" + text("motor_step").replace("\n", "\r\n").encode()
    measurement = read(case("motor_step", data=data))
    assert csv_of(measurement) == csv_of(read(case("motor_step")))


def test_mixed_line_ends_are_read_and_said(case, text):
    measurement = read(case("motor_step", data=text("motor_step").replace("\n", "\r\n", 2)))
    assert any("mixes line ends: 2 of 6 rows" in note for note in measurement.notes)
    assert measurement.rows == 5


def test_a_last_number_without_line_end_is_taken_for_missing_and_said(case, text):
    measurement = read(case("motor_step", data=text("motor_step").removesuffix("\n")))
    assert measurement.trials[1]["omega_rad_s"].quality[-1] == MISSING
    assert any("column omega_rad_s may be cut off" in note for note in measurement.notes)


BAD_NOMINAL = {
    "unknown kind": ("kind: motor_stedy\n", "kind: got 'motor_stedy'.*did you mean motor_steady"),
    "no kind": ("motor: {}\n", "kind: got nothing"),
    "unknown key": ("kind: motor_step\nmotr: 1\n", r"nominal.yaml:2: motr: unknown key.*did you mean motor"),
    "negative resistance": (
        lambda text: text.replace("{value: 3.0,", "{value: -3.0,"),
        "winding_resistance_ohm.value: got -3",
    ),
    "no tolerance": (lambda text: text.replace(", tolerance: 0.03}", "}"), "winding_resistance_ohm.tolerance: missing"),
    "no YAML": ("kind: [motor_step\n", "not valid YAML"),
}


@pytest.mark.parametrize("fault", BAD_NOMINAL)
def test_bad_nominal_parameters_are_refused_with_line_and_field(case, fault):
    spoil, pattern = BAD_NOMINAL[fault]
    good = (case("motor_step") / "nominal.yaml").read_text()
    message = refusal(case("motor_step", nominal=spoil(good) if callable(spoil) else spoil))
    assert "nominal.yaml" in message
    assert re.search(pattern, message), message


def test_a_case_without_its_data_says_which_file_lacks(case):
    folder = case("motor_step")
    (folder / "data.csv").unlink()
    assert "there is no data.csv" in refusal(folder)


def test_an_unknown_folder_says_what_would_be_known(tmp_path):
    assert re.search("is not measured data of a known form.*motor_steady.*nominal.yaml and data.csv", refusal(tmp_path))


def test_a_path_that_is_not_there_is_said_to_be_so(tmp_path):
    assert "no such file or folder" in refusal(tmp_path / "nowhere")


EXPECTED_LINE = {
    "motor_steady": r"omega_rad_s +rad/s +reading +5 +1 +- +- +- +0 +15.71 ",
    "motor_step": r"current_A +A +reading +5 +1 +- +- +- +-0.99 +0.98 ",
    "tof_bench": r"reading_m +m +reading +3 +1 +1 +- +- +0.321 +0.321 ",
    "drive_log": r"tof_left_m +m +reading +5 +3 +2 +- +- +- +- ",
}


@pytest.mark.parametrize("kind", KINDS)
def test_the_overview_counts_what_is_missing_and_without_target(case, kind):
    lines = overview(read(case(kind)))
    assert lines[0].startswith(f"{kind}: {kind}, ")
    assert any(re.match(EXPECTED_LINE[kind], line) for line in lines), "\n".join(lines)


def test_a_range_bench_that_noted_distances_alone_is_read(case, text):
    """Ten times the same board, without a word of material, angle, temperature or light."""
    rows = [f"{i},fit,{i}.0,0.2,,,,,0.2{i % 3:02}" for i in range(1, 13)]
    measurement = read(case("tof_bench", data="\n".join([text("tof_bench").splitlines()[0], *rows]) + "\n"))
    assert "not logged: incidence_rad, temperature_C, ambient_lux" in measurement.notes
    lines = overview(measurement)
    assert "material: (not noted)" in lines
    assert any(re.search(r"^reading_m .* 11 repeats", line) for line in lines)


@pytest.mark.parametrize(
    ("kind", "coefficients", "pattern"),
    [
        ("tof_bench", "[-1.4, 4.88, 2.51, 1.15]", r"noise\.polynomial_mm: .* -1.4 mm at 0.14 m.*above 0"),
        ("tof_bench", "[0, 0, 0, 0]", r"noise\.polynomial_mm: .* 0 mm at 0.14 m.*above 0"),
        ("drive_log", "[1.4, -4.88, 0, 0]", r"noise\.tof_polynomial_mm: .* -0.\d+ mm at 0.46[78] m.*above 0"),
    ],
)
def test_a_noise_that_is_not_above_zero_at_the_distances_is_refused(case, kind, coefficients, pattern):
    """1.4 - 4.88 x is 0 at x = 0.287, that is at 0.467 m."""
    nominal = (case(kind) / "nominal.yaml").read_text().replace("[1.4, 4.88, 2.51, 1.15]", coefficients)
    message = refusal(case(kind, nominal=nominal))
    assert "nominal.yaml" in message
    assert re.search(pattern, message), message


def test_a_noise_that_is_negative_beyond_the_distances_is_read(case):
    """1.4 - 2 x is above 0 up to 0.88 m; the bench goes to 0.54 m."""
    nominal = (case("tof_bench") / "nominal.yaml").read_text().replace("[1.4, 4.88, 2.51, 1.15]", "[1.4, -2, 0, 0]")
    (trial,) = read(case("tof_bench", nominal=nominal)).trials
    assert trial["reading_m"].noise_sd[2] == pytest.approx((1.4 - 2 * 0.36) / 1000)


def test_a_heading_that_wraps_is_refused_at_its_row(case, text):
    """0.1 rad a row, given within half a turn: the fourth row goes from 3.1 to -3.08."""
    rows = [
        f"1,fit,{0.05 * k:.2f},{0.05 * k:.2f},,,,,{k},{k},,,,1.0,0.8,{theta}"
        for k, theta in enumerate((2.9, 3.0, 3.1, -3.08, -2.98))
    ]
    message = refusal(case("drive_log", data="\n".join([text("drive_log").splitlines()[0], *rows]) + "\n"))
    assert re.search(r"row 5: column theta_rad: goes from 3.1 to -3.08.*unwrap the angle", message), message


@pytest.mark.parametrize("spelling", ["'kind': motor_step", "kind : motor_step", '"kind": "motor_step"'])
def test_any_spelling_of_the_kind_that_is_yaml_is_known(case, spelling):
    nominal = (case("motor_step") / "nominal.yaml").read_text().replace("kind: motor_step", spelling)
    assert read(case("motor_step", nominal=nominal)).kind is CaseKind.MOTOR_STEP


def test_a_nominal_file_in_flow_style_is_known(case):
    nominal = yaml.safe_load((case("motor_step") / "nominal.yaml").read_text())
    flow = yaml.safe_dump(nominal, default_flow_style=True, width=10_000)
    assert flow.startswith("{")
    assert read(case("motor_step", nominal=flow)).kind is CaseKind.MOTOR_STEP


def test_digits_beyond_the_usual_ones_come_back_from_what_was_written(case, text, tmp_path):
    """150 Hz to nine decimals, a voltage to six: the same numbers, not their roundings."""
    rows = [f"1,fit,{k / 150:.9f},{k / 150:.9f},3.123456,0.12345678,1.1234567" for k in range(1, 20)]
    nominal = (case("motor_step") / "nominal.yaml").read_text().replace("200", "150")
    data = "\n".join([text("motor_step").splitlines()[0], *rows]) + "\n"
    measurement = read(case("motor_step", data=data, nominal=nominal))
    write_case(measurement, tmp_path / "again")
    again = read(tmp_path / "again")
    (before,), (after,) = measurement.trials, again.trials
    np.testing.assert_array_equal(after.t_s, before.t_s)
    for channel in before.channels:
        np.testing.assert_array_equal(after[channel.name].values, channel.values)


def test_sections_of_a_drive_may_be_left_out_and_what_is_not_compared_is_noted(case):
    tree = yaml.safe_load((case("drive_log") / "nominal.yaml").read_text())
    del tree["tof"]["mount"]["left"]
    measurement = read(case("drive_log", nominal=yaml.safe_dump(tree)))
    assert measurement.notes == ("nominal.yaml has no tof.mount.left: the ranges tof_left_m are not compared",)
    del tree["motor"], tree["world"]
    measurement = read(case("drive_log", nominal=yaml.safe_dump(tree)))
    assert measurement.notes == (
        "nominal.yaml has no section motor: speeds are not compared with voltages",
        "nominal.yaml has no section world: ranges are not compared",
    )


def test_millimetres_that_were_taken_for_centimetres_are_recognised_by_what_the_wheels_did(case, text):
    """Straight on: both wheels count alike, and the pose travels ten times as far as they roll."""
    per_tick_m = 2 * np.pi * 0.03 / 1920
    rows = [
        f"1,fit,{n / 400:.2f},{n / 400:.2f},,,,,{n},{n},,,,{10 * n * per_tick_m:.5f},0.8,0.0" for n in range(0, 800, 20)
    ]
    data = "\n".join([text("drive_log").splitlines()[0], *rows]) + "\n"
    notes = read(case("drive_log", data=data)).notes
    assert any(
        re.search("CHECK THE UNIT of x_m and y_m.*10 times.*mm and was taken for cm: divide by 10", n) for n in notes
    )


def test_a_step_log_in_degrees_per_second_is_recognised_although_the_motor_runs_up(case):
    """Half of each step passes before the motor is fast: a first-order lag of 0.5 s at K = 0.3."""
    times = 0.005 * np.arange(1, 201)
    speeds = np.degrees(4.0 / 0.3 * (1.0 - np.exp(-times / 0.5)))
    rows = [f"1,fit,{t:.3f},{t:.3f},4.0,0.08,{speed:.3f}" for t, speed in zip(times, speeds, strict=True)]
    data = "\n".join(["trial,split,session_time_s,t_s,u_cmd_V,current_A,omega_rad_s", *rows]) + "\n"
    (note,) = read(case("motor_step", data=data)).notes
    assert re.search("CHECK THE UNIT of omega_rad_s.*degrees per second: divide by 57.3", note)


def test_a_broken_file_of_parameters_is_parsed_once(case, monkeypatch):
    """The importer of each kind asks whether it knows the file, and each parsed it: 3 s for 100 kB."""
    folder = case("drive_log", nominal=(case("drive_log") / "nominal.yaml").read_text() + "motor: [\n")
    parsed, builder = [], reader._Builder
    monkeypatch.setattr(reader, "_Builder", lambda *args, **options: parsed.append(args) or builder(*args, **options))
    assert "not valid YAML" in refusal(folder)
    assert len(parsed) == 2  # by the fast parser, and by the one that can say what is wrong
