"""Columns that the user chooses with `--column`, beside those that are recognised by their names."""

import re
import shlex

import numpy as np
import pytest
import yaml

from diagnosis.measured.measurement import CaseKind
from diagnosis.new_case.quantities import KINDS


def renamed(columns, **names):
    return {names.get(name, name): column for name, column in columns.items()}


def test_a_chosen_column_completes_those_that_are_recognised(init, columns, tmp_path):
    init(columns, "--out", "by_name")
    code, out, err, _ = init(renamed(columns, time_ms="loop_ms"), "--column", "t_s=loop_ms")
    assert (code, err) == (0, "")
    assert "t_s             from loop_ms, in ms" in out
    by_name, chosen = (
        yaml.safe_load((tmp_path / case / "mapping.yaml").read_text())["columns"] for case in ("by_name", "run")
    )
    assert chosen == {**by_name, "t_s": {"column": "loop_ms", "unit": "ms"}}


def test_a_chosen_column_is_no_count_of_a_third_wheel(init, columns):
    """`tick` alone would be taken for one."""
    code, out, err, _ = init(renamed(columns, time_ms="tick"), "--column", "t_s=tick")
    assert (code, err) == (0, "")
    assert "tick (t_s): the name has no unit; taken for ms" in out


def test_an_error_about_three_wheels_names_the_options_that_choose_the_two_to_compare(init, columns):
    code, _, err, _ = init(renamed(columns, time_ms="tick"))
    assert code == 2
    assert "counts of 3 wheels: tick, enc_l, enc_r" in err
    assert (
        "choose them with --column enc_left_ticks=enc_l --column enc_right_ticks=enc_r; if a column is no count" in err
    )
    assert "name what it is with --column QUANTITY=COLUMN" in err


def filtered(columns):
    return {**columns, "enc_l_filtered": columns["enc_l"], "enc_r_filtered": columns["enc_r"]}


@pytest.mark.parametrize("sides", [("left", "right"), ("right", "left")])
def test_chosen_counts_of_both_wheels_go_before_all_others(sides, init, columns):
    chosen = [word for side in sides for word in ("--column", f"enc_{side}_ticks=enc_{side[0]}_filtered")]
    code, out, err, _ = init(filtered(columns), *chosen)
    assert (code, err) == (0, "")
    assert "from enc_l_filtered" in out
    assert "from enc_r_filtered" in out


def test_a_chosen_count_goes_before_those_of_its_side(init, columns):
    logged = {name: column for name, column in filtered(columns).items() if name != "enc_r_filtered"}
    code, _, err, _ = init(logged, "--column", "enc_left_ticks=enc_l_filtered")
    assert (code, err) == (0, "")


def test_beside_a_chosen_count_wheels_without_a_side_are_still_too_many(init, columns):
    logged = {"enc1": columns["enc_l"], "enc2": columns["enc_r"], **columns}
    code, _, err, _ = init(renamed(logged, enc_l="enc3", enc_r="enc4"), "--column", "enc_left_ticks=enc1")
    assert code == 2
    assert "counts of 4 wheels: enc2, enc3, enc4, enc1" in err
    assert "choose them with --column enc_left_ticks=enc1 --column enc_right_ticks=COLUMN" in err


def test_the_command_that_takes_a_column_is_in_the_error(init, columns):
    code, _, err, _ = init(renamed(columns, time_ms="loop_ms"))
    assert code == 2
    assert "no column was recognised as t_s" in err
    assert "not recognised: loop_ms; name the column of each, such as --column t_s=loop_ms" in err


def test_a_chosen_column_goes_before_one_whose_name_fits(init, columns):
    _, out, _, _ = init({**columns, "x_filtered": np.asarray(columns["x_cm"]) / 100}, "--column", "x_m=x_filtered")
    assert "x_m             from x_filtered" in out
    assert "not used: x_cm" in out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--column", "t_s=loopms"), "--column t_s: the log has no such column: got 'loopms'"),
        (("--column", "time=loop_ms"), "--column: no quantity of a log: got 'time'"),
        (("--column", "t_s"), "--column: got 't_s', allowed: QUANTITY=COLUMN, such as t_s=loop_ms"),
        (("--column", "t_s=loop_ms", "--column", "t_s=enc_l"), "--column t_s: given twice"),
        (("--column", "t_s=loop_ms", "--column", "x_m=loop_ms"), "--column x_m: the column of t_s, too: got 'loop_ms'"),
        (("--column", "t_s=loop_ms", "--kind", "tof_bench"), "no column was recognised as distance_m reading_m"),
        (("--column", "reading_m=loop_ms", "--kind", "drive_log"), "--column: no quantity of a drive_log"),
        (("--column", "t_s=loop_ms", "--mapping", "mapping.yaml"), "--column: a mapping file names every column"),
    ],
)
def test_a_choice_that_does_not_fit_is_refused(arguments, message, init, columns, tmp_path):
    (tmp_path / "mapping.yaml").write_text("kind: drive_log\n")
    code, _, err, _ = init(renamed(columns, time_ms="loop_ms"), *arguments)
    assert code == 2
    assert message in err


@pytest.mark.parametrize(
    ("name", "unit", "quantity", "allowed"),
    [("a b=c", "degC", "t_s", "s, ms, us, ns"), ("shaft_rpm", "rpm", "x_m", "m, mm, cm")],
)
def test_a_chosen_column_in_a_unit_of_something_else_is_refused(name, unit, quantity, allowed, init, columns):
    code, _, err, _ = init({name: columns["time_ms"], **columns}, "--column", f"{quantity}={name}")
    assert code == 2
    where = f"--column {quantity}={name}: the name of the column seems to state the unit {unit}"
    assert f"{where}; allowed: {allowed}" in err
    assert "rename the column, or write a mapping.yaml" in err


@pytest.mark.parametrize(
    ("names", "first"),
    [
        ({"enc_l": "foo", "enc_r": "bar"}, "enc_left_ticks=foo"),
        ({"enc_l": "foo", "enc_r": "bar", "time_ms": "tijd"}, "t_s=tijd"),
        ({"enc_l": "enc_1", "enc_r": "enc_2", "time_ms": "tijd"}, "t_s=tijd"),
        ({"enc_l": "enc_1"}, "enc_left_ticks=enc_1"),
    ],
)
def test_the_example_for_a_log_without_counts_is_no_range(names, first, init, columns):
    code, _, err, _ = init(renamed(columns, **names))
    assert code == 2
    assert f"such as --column {first};" in err


def test_the_example_for_missing_counts_is_a_column_of_counts(init, columns):
    logged = renamed({"battery": columns["x_cm"], **columns}, enc_l="enc_1", enc_r="enc_2")
    _, _, err, _ = init(logged)
    assert "such as --column enc_left_ticks=enc_1;" in err


@pytest.mark.parametrize("name", ["uptime_ms", "uptime", "millis"])
def test_the_clock_of_a_microcontroller_is_a_time(name):
    assert KINDS[CaseKind.DRIVE_LOG].matched([name]) == {"t_s": name}


def test_headings_in_degrees_that_are_called_radians_are_named_where_the_ticks_are_missing(init, columns):
    """The ticks of a turn could be estimated from the poses, if the headings followed the path."""
    logged = {name: column for name, column in columns.items() if name != "heading_deg"}
    code, _, err, _ = init({**logged, "heading_rad": columns["heading_deg"]})
    assert code == 2
    assert "without poses" not in err
    assert "it cannot be estimated, since the headings follow the path in degrees and not in rad" in err
    assert "write unit: degrees for theta_rad" in err


def test_poses_that_contradict_the_ticks_are_named_where_the_ticks_are_missing(init, columns):
    exchanged = renamed(columns, enc_l="enc_r", enc_r="enc_l")
    code, _, err, _ = init(exchanged)
    assert code == 2
    assert "it cannot be estimated, since theta_rad turns against the wheels: exchange left and right" in err


def test_a_number_in_another_unit_is_named_with_its_value_in_ours(init, columns):
    _, _, err, _ = init(columns, "--set", "wheel_diameter_m=65")
    assert (
        "wheel_diameter_m: got 65, allowed: a number, above 0 to 0.5; is it in metres? 65 mm are 0.065"
        in err.replace("'", "")
    )


def advised(error):
    """Return the words of the option in the advice of an error."""
    return shlex.split(re.search(r"such as (--column [^;]+);", error)[1])


def test_the_advised_column_can_have_the_unit_of_the_quantity_and_the_advice_works(init, columns):
    """A battery in mV is no time, and neither is a heading that goes back."""
    extra = {"battery_mV": np.full(len(columns["x_cm"]), 7400), "spin_deg": columns["heading_deg"]}
    logged = {**extra, **renamed(columns, time_ms="loop")}
    code, _, err, _ = init(logged)
    assert code == 2
    assert advised(err) == ["--column", "t_s=loop"]
    code, _, err, _ = init(logged, *advised(err))
    assert (code, err) == (0, "")


def test_without_a_column_that_can_be_the_missing_quantity_the_advice_names_none(init, columns):
    logged = {"battery_mV": np.full(len(columns["x_cm"]), 7400), **columns}
    del logged["time_ms"]
    code, _, err, _ = init(logged)
    assert code == 2
    assert "none of these seems to be one; if one is, name it with --column QUANTITY=COLUMN; or rename them" in err


@pytest.mark.parametrize("name", ["leftMode", "z", "qw", "leftSpeed", "intensity", "leftCommand", "pitch_deg", "secs"])
def test_a_column_of_something_else_is_no_example(name, init, columns):
    """A mode of two values is no place, a height no heading, and a speed no count."""
    values = np.arange(len(columns["x_cm"])) % 2 if name == "leftMode" else np.arange(len(columns["x_cm"]))
    values = values % 97 if name != "secs" else values // 20
    logged = {"time_ms": columns["time_ms"], "enc_l": columns["enc_l"], "enc_r": columns["enc_r"], name: values}
    code, _, err, _ = init(logged)
    assert code == 2
    assert "no column was recognised as x_m y_m theta_rad, or else as u_left_V u_right_V" in err
    if name != "leftCommand":
        assert "none of these seems to be one" in err
    else:
        assert "such as --column u_left_V=leftCommand;" in err


def test_numbers_that_are_not_whole_are_no_example_of_counts(init, columns):
    logged = renamed(columns, enc_l="foo", enc_r="bar")
    _, _, err, _ = init({"voltage [V]": columns["x_cm"], "spring": columns["x_cm"], **logged})
    assert "such as --column enc_left_ticks=foo;" in err


def test_a_log_of_a_motor_without_a_speed_is_of_neither_kind(init):
    speeds = {f"{side}SpeedRpm": 2 * np.arange(40) for side in ("left", "right")}
    logged = {"time": 1100 * np.arange(40), "motorCommand": np.arange(40), **speeds}
    _, _, err, _ = init(logged)
    assert "which a log of the kind motor_step or motor_steady needs" in err
    assert "such as --column omega_rad_s=leftSpeedRpm;" in err


def test_of_a_log_with_counts_alone_poses_are_named_before_voltages(init, columns):
    code, _, err, _ = init({name: columns[name] for name in ("time_ms", "enc_l", "enc_r")})
    assert code == 2
    assert "no column was recognised as x_m y_m theta_rad, or else as u_left_V u_right_V, which" in err


def test_inches_in_the_name_of_a_place_are_inches(init, columns, tmp_path):
    inches = {
        "x_in": np.round(np.asarray(columns["x_cm"]) / 2.54, 6),
        "y_in": np.round(np.asarray(columns["y_cm"]) / 2.54, 6),
    }
    logged = {name: column for name, column in columns.items() if name not in {"x_cm", "y_cm"}}
    init(columns, "--out", "in_cm")
    code, out, err, _ = init({**logged, **inches})
    assert (code, err) == (0, "")
    assert "x_m             from x_in, in in" in out
    in_cm, in_inches = (
        np.genfromtxt(tmp_path / case / "data.csv", delimiter=",", names=True)["x_m"] for case in ("in_cm", "run")
    )
    np.testing.assert_allclose(in_inches, in_cm, atol=1e-6)


def test_a_chosen_column_with_an_unknown_unit_in_brackets_is_refused_and_not_guessed(init, columns):
    code, _, err, _ = init(renamed(columns, x_cm="x [furlong]"), "--column", "x_m=x [furlong]")
    assert code == 2
    assert "--column x_m=x [furlong]: the name of the column states furlong, which is no known unit" in err
    assert "allowed: m, mm, cm, um, in, ft" in err


def test_grad_is_taken_for_degrees_with_a_word_on_gon(init, columns):
    code, out, _, _ = init(renamed(columns, heading_deg="heading_grad"))
    assert code == 0
    assert "heading_grad (theta_rad): taken for degrees; if a turn has 400, write unit: gon in mapping.yaml" in out


@pytest.mark.parametrize("name", ["x_furlong", "x furlong", "pos_x_furlongs"])
def test_a_chosen_column_with_an_unknown_unit_behind_its_name_is_asked_for(name, init, columns):
    code, _, err, _ = init(renamed(columns, x_cm=name), "--column", f"x_m={name}")
    assert code == 2
    unit = name.replace("_", " ").split()[-1]
    assert f"--column x_m={name}: the name of the column may state the unit {unit}, which is not known" in err
    assert "--unit x_m=m" in err
    code, out, err, _ = init(renamed(columns, x_cm=name), "--column", f"x_m={name}", "--unit", "x_m=cm")
    assert (code, err) == (0, "")
    assert f"x_m             from {name}, in cm" in out


def test_counts_whose_name_ends_in_rev_can_be_chosen_with_their_unit(init, columns):
    chosen = [f"--column=enc_{side}_ticks={side}_rev" for side in ("left", "right")]
    logged = renamed(columns, enc_l="left_rev", enc_r="right_rev")
    code, _, err, _ = init(logged, *chosen)
    assert code == 2
    assert "the name of the column seems to state the unit turns" in err
    assert "if it is in ticks all the same, add --unit enc_left_ticks=ticks" in err
    assert "such as factor: 1440 for turns of 1440 ticks each" in err
    code, _, err, _ = init(logged, *chosen, *(f"--unit=enc_{side}_ticks=ticks" for side in ("left", "right")))
    assert (code, err) == (0, "")


def test_turns_of_a_wheel_become_ticks_by_a_factor(init, columns, tmp_path):
    """The log has turns with four digits, of which 1440 ticks make one."""
    turned = renamed(columns, enc_l="left_rev", enc_r="right_rev")
    turned |= {name: np.round(turned[name] / 1440, 4) for name in ("left_rev", "right_rev")}
    assert init(columns, "--out", "counted")[0] == 0
    mapping = (tmp_path / "counted" / "mapping.yaml").read_text()
    for side in ("left", "right"):
        mapping = mapping.replace(f'"enc_{side[0]}"', f'"{side}_rev", factor: 1440')
    (tmp_path / "turns.yaml").write_text(mapping)
    code, _, err, _ = init(turned, "--mapping", "turns.yaml", "--out", "turned")
    assert (code, err) == (0, "")
    ticks = [np.genfromtxt(tmp_path / case / "data.csv", delimiter=",", names=True) for case in ("counted", "turned")]
    np.testing.assert_array_equal(ticks[1]["enc_left_ticks"], ticks[0]["enc_left_ticks"])


def test_a_column_of_an_estimator_can_be_chosen_without_its_unit(init, columns):
    code, out, err, _ = init(renamed(columns, heading_deg="yaw_kalman"), "--column", "theta_rad=yaw_kalman")
    assert (code, err) == (0, "")
    assert "yaw_kalman (theta_rad): the name has no unit; taken for degrees" in out


def test_speeds_of_wheels_are_named_where_their_counts_are_missing(init, columns):
    code, _, err, _ = init(renamed(columns, enc_l="speed_left_rad_s", enc_r="speed_right_rad_s"))
    assert code == 2
    assert (
        "a speed of a wheel, such as speed_left_rad_s, cannot take the place of its count: log the counts, or " in err
    )
    assert "cannot take the place" not in init(renamed(columns, enc_l="foo", enc_r="bar"))[2]


def test_the_command_that_follows_can_be_typed(init, columns):
    _, out, _, _ = init(columns, "--out", "my case")
    assert "symolo diagnose 'my case' --out 'my case-diagnosis'" in out
