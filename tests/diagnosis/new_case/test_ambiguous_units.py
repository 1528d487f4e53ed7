"""Units that neither the name of a column nor its values show: the command asks for them and guesses none."""

import numpy as np
import pytest
import yaml

DUTY = np.arange(-254, 254, 4)
"""Commands of a controller with 8 bits, as a sweep of a motor in both directions logs them."""


def sweep(step, **renamed):
    """Return a log with one steady state in each row: time, command and speed."""
    columns = {
        "time": 17800 + step * np.arange(len(DUTY)),
        "motorCommand": DUTY,
        "leftSpeedRpm": np.round(2.5 * DUTY, 2),
    }
    return {renamed.get(name, name): column for name, column in columns.items()}


def columns_of(tmp_path):
    return yaml.safe_load((tmp_path / "run" / "mapping.yaml").read_text())["columns"]


CHOSEN = ("--column", "omega_rad_s=leftSpeedRpm", "--set", "supply_voltage_V=8")


def test_a_command_up_to_254_is_asked_for_and_never_taken_for_millivolts(init):
    code, _, err, _ = init(sweep(1100), *CHOSEN, "--unit", "t_s=ms")
    assert code == 2
    assert "run.csv: row 1: column motorCommand: its unit is not known, and the values up to 254 do not show it" in err
    assert "duty_255: a duty cycle of which 255 is full, so up to 7.969 V of the supply's 8 V" in err
    assert "mV: up to 0.254 V" in err
    assert "state it, such as --unit u_cmd_V=duty_255" in err


def test_a_stated_duty_cycle_is_the_share_of_the_supply(init, tmp_path):
    code, out, err, _ = init(sweep(1100), *CHOSEN, "--unit", "t_s=ms", "--unit", "u_cmd_V=duty_255")
    assert (code, err) == (0, "")
    assert out.startswith("run: motor_steady")
    volts = np.genfromtxt(tmp_path / "run" / "data.csv", delimiter=",", names=True)["u_cmd_V"]
    np.testing.assert_allclose(volts, DUTY / 255 * 8, atol=1e-6)


@pytest.mark.parametrize(
    ("unit", "kind", "between"), [("ms", "motor_steady", "1.1 s"), ("us", "motor_step", "0.0011 s")]
)
def test_times_that_may_be_steady_states_or_samples_are_asked_for(unit, kind, between, init):
    code, _, err, _ = init(sweep(1100), *CHOSEN, "--unit", "u_cmd_V=duty_255")
    assert code == 2
    assert "column time: its unit is not known, and rows that are 1100 apart do not show it" in err
    assert f"{unit}: rows are {between} apart" in err
    code, out, err, _ = init(sweep(1100), *CHOSEN, "--unit", "u_cmd_V=duty_255", "--unit", f"t_s={unit}")
    assert (code, err) == (0, "")
    assert out.startswith(f"run: {kind}")


@pytest.mark.parametrize(("kind", "unit"), [("motor_steady", "ms"), ("motor_step", "us")])
def test_a_stated_kind_shows_the_unit_of_the_times(kind, unit, init, tmp_path):
    code, out, err, _ = init(sweep(1100), *CHOSEN, "--unit", "u_cmd_V=duty_255", "--kind", kind)
    assert (code, err) == (0, "")
    assert columns_of(tmp_path)["t_s"] == {"column": "time", "unit": unit}
    assert f"time (t_s): the name has no unit; taken for {unit}" in out


def test_all_units_that_are_not_known_are_asked_for_at_once(init):
    code, _, err, _ = init(sweep(1100), *CHOSEN)
    assert code == 2
    assert "2 faults" in err
    assert "column motorCommand" in err
    assert "column time" in err


@pytest.mark.parametrize("name", ["u", "motor", "voltage"])
@pytest.mark.parametrize("largest", [0.9, 250.0])
def test_a_voltage_that_no_small_robot_has_is_asked_for(name, largest, init):
    u = largest / 254 * DUTY
    code, _, err, _ = init({"time [s]": np.arange(len(u)), name: u, "speed [rpm]": DUTY})
    assert code == 2
    assert f"column {name}: its unit is not known, and the values up to {largest:g} do not show it" in err


@pytest.mark.parametrize(("name", "largest", "unit"), [("u", 7.4, ""), ("voltage", 7400.0, "mV"), ("motor", 12.0, "")])
def test_a_usual_voltage_is_not_asked_for(name, largest, unit, init, tmp_path):
    u = np.round(largest / 254 * DUTY, 3)
    code, _, err, _ = init({"time [s]": np.arange(len(u)), name: u, "speed [rpm]": DUTY})
    assert (code, err) == (0, "")
    assert columns_of(tmp_path)["u_cmd_V"].get("unit", "") == unit


def test_a_current_that_may_be_in_milliamperes_is_asked_for(init):
    log = {"time [s]": np.arange(len(DUTY)), "u [V]": DUTY / 50, "i": np.abs(DUTY) / 5}
    code, _, err, _ = init(log)
    assert code == 2
    assert "column i: its unit is not known, and the values up to 50.8 do not show it" in err
    assert "A: up to 50.8 A" in err
    assert "mA: up to 0.0508 A" in err


@pytest.mark.parametrize(
    ("unit", "message"),
    [
        ("u_cmd_V", "--unit: got 'u_cmd_V', allowed: QUANTITY=UNIT, such as u_left_V=mV"),
        ("u_cmd_V=duty_0", "--unit u_cmd_V: got 'duty_0'"),
        ("u_cmd_V=rpm", "--unit u_cmd_V: got 'rpm', allowed: V, mV, percent, duty_1, duty_255"),
        ("voltage=mV", "--unit: no quantity of a log: got 'voltage'"),
        ("x_m=mm", "--unit x_m: no column was recognised as x_m"),
    ],
)
def test_a_stated_unit_that_does_not_fit_is_refused(unit, message, init):
    code, _, err, _ = init(sweep(1100), *CHOSEN, "--unit", "t_s=ms", "--unit", unit)
    assert code == 2
    assert message in err


def test_all_stated_units_without_a_column_are_listed_in_the_order_of_the_command(init):
    code, _, err, _ = init(sweep(1100), *CHOSEN, "--unit", "t_s=ms", "--unit", "y_m=mm", "--unit", "x_m=mm")
    assert code == 2
    assert err.startswith("symolo: 3 faults:")
    assert (
        0 < err.index("--unit y_m: no column") < err.index("--unit x_m: no column") < err.index("column motorCommand")
    )


def test_a_stated_unit_goes_before_that_of_the_name(init, columns, tmp_path):
    logged = {"x_m" if name == "x_cm" else name: column for name, column in columns.items()}
    code, _, err, _ = init(logged, "--unit", "x_m=cm")
    assert (code, err) == (0, "")
    assert columns_of(tmp_path)["x_m"] == {"column": "x_m", "unit": "cm"}


def test_a_unit_is_stated_in_the_mapping_file_if_there_is_one(init, columns, tmp_path):
    (tmp_path / "mapping.yaml").write_text("kind: drive_log\ncolumns: {t_s: {column: time_ms}}\n")
    code, _, err, _ = init(columns, "--mapping", "mapping.yaml", "--unit", "t_s=ms")
    assert code == 2
    assert "--unit: a mapping file names the unit of every column" in err


@pytest.mark.parametrize("largest", [150, 90])
def test_chosen_columns_of_duty_cycles_share_the_full_value_of_the_largest_one(largest, init, columns, tmp_path):
    """No name states a side, so that only the user knows which wheel is which."""
    others = {name: column for name, column in columns.items() if not name.startswith("motor")}
    duty = np.round(100.0 + 50.0 * np.sin(np.arange(len(columns["time_ms"])))).astype(int)
    logged = others | {"pwm_1": duty, "pwm_2": duty * largest // 150}
    chosen = [text for name in ("u_left_V=pwm_1", "u_right_V=pwm_2") for text in ("--column", name)]
    numbers = ("supply_voltage_V=7.4", "ticks_per_turn=1440", "wheel_diameter_m=0.066", "track_m=0.14")
    code, _, err, _ = init(logged, *chosen, *(text for number in numbers for text in ("--set", number)))
    assert (code, err) == (0, "")
    factors = [columns_of(tmp_path)[name]["factor"] for name in ("u_left_V", "u_right_V")]
    assert factors == pytest.approx([7.4 / 255, 7.4 / 255])


@pytest.mark.parametrize("scale", [0.1, 2.5])
def test_a_column_that_is_called_by_a_unit_alone_is_in_it(scale, init, tmp_path):
    u = scale * np.arange(1, 11)
    code, _, err, _ = init({"V": u, "i [A]": np.round(0.2 + 0.01 * u, 4), "rpm": 20.0 * u})
    assert (code, err) == (0, "")
    assert columns_of(tmp_path)["u_cmd_V"] == {"column": "V"}


NUMBERS = (
    "--set=ticks_per_turn=1440",
    "--set=wheel_diameter_m=0.065",
    "--set=track_m=0.14",
    "--set=supply_voltage_V=8",
)


def slow_drive(columns, names, largest):
    """Return a drive whose motors get at most this value, and not the voltages of the columns."""
    logged = {name: column for name, column in columns.items() if not name.startswith("motor")}
    voltages = np.array([columns[f"motor_{side} [mV]"] for side in "lr"])
    return logged | dict(zip(names, np.round(voltages / voltages.max() * largest).astype(int), strict=True))


def test_a_duty_cycle_below_100_is_asked_for(columns, init):
    """80 may be 80 % or 80 of 255, at which the motors get 2.5 V of 8 V."""
    log = slow_drive(columns, ("pwm_l", "pwm_r"), 80)
    code, _, err, _ = init(log, *NUMBERS)
    assert code == 2
    assert "column pwm_l: its unit is not known, and the values up to 80 do not show it" in err
    assert "such as --unit u_left_V=percent; percent: a duty cycle of which 100 is full, so up to 6.4 V" in err
    assert "duty_255: a duty cycle of which 255 is full, so up to 2.51 V" in err


@pytest.mark.parametrize("names", [("pwm_l", "pwm_r"), ("motor_l", "motor_r")])
def test_the_unit_of_one_wheel_is_that_of_both(names, columns, init, tmp_path):
    code, _, err, _ = init(slow_drive(columns, names, 80), *NUMBERS, "--unit", "u_left_V=duty_255")
    assert (code, err) == (0, "")
    factors = [columns_of(tmp_path)[name]["factor"] for name in ("u_left_V", "u_right_V")]
    np.testing.assert_allclose(factors, 8 / 255)


def test_a_wheel_with_less_than_15_is_in_volts_only_if_both_are(columns, init):
    """A wheel that got at most 14 of 255 while the other one got 200."""
    log = slow_drive(columns, ("motor_l", "motor_r"), 200)
    log["motor_l"] = np.round(log["motor_l"] * 14 / 200).astype(int)
    code, _, err, _ = init(log, *NUMBERS)
    assert code == 2
    assert "column motor_l: its unit is not known, and the values up to 200 do not show it" in err
    assert "column motor_r: its unit is not known, and the values up to 200 do not show it" in err


def test_a_logged_battery_is_named_where_the_supply_is_not_known(columns, init):
    log = slow_drive(columns, ("pwm_l", "pwm_r"), 255)
    log["vbat_mV"] = np.full(len(log["pwm_l"]), 7900)
    code, out, _, _ = init(log, *NUMBERS[:3])
    assert code == 0
    assert "a mapping may multiply a duty cycle by vbat_mV (docs/case_from_log.md)" in out
