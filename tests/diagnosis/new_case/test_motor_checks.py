"""Signs that a number of a motor, or the unit or sign of what was logged of it, is wrong."""

import re

import numpy as np
import pytest

from diagnosis.importers.cases.motor_checks import number_checks, speed_checks
from diagnosis.measured.case_files.nominal import NominalMotor
from tests.diagnosis.new_case.drives import SLOPE, TC, TICKS, B, K, R


@pytest.fixture
def bench():
    """Steady states of a motor with u = R i + K w and K i = B w + Tc, of which (R, K) = (3 ohm, 0.3 N m/A)."""
    u = np.linspace(1.0, 6.0, 24)
    w = (u - R * TC / K) / SLOPE
    return {"u [V]": u, "current [A]": (TC + B * w) / K, "speed [rad/s]": w}


def settings(**known):
    return [word for key, value in known.items() for word in ("--set", f"{key}={value}")]


def checks(out):
    return re.findall("CHECK (.*)", out)


def test_a_right_bench_and_right_numbers_give_no_check(init, bench):
    known = settings(winding_resistance_ohm=R, torque_constant_N_m_A=K, supply_voltage_V=6.0)
    code, out, err, _ = init(bench, *known)
    assert (code, err, checks(out)) == (0, "", [])


@pytest.mark.parametrize("known", [{}, {"winding_resistance_ohm": R, "torque_constant_N_m_A": K}])
def test_volts_that_are_called_millivolts_are_named(known, init, bench):
    bench["u [mV]"] = bench.pop("u [V]")
    _, out, _, _ = init(bench, *settings(**known))
    (check,) = checks(out)
    assert check.startswith(
        "THE UNIT of u_cmd_V: the motor turns at 0.006 V at most, as if the values were in V and were"
    )


@pytest.mark.parametrize(("column", "words"), [("speed [rad/s]", "omega_rad_s"), ("current [A]", "current_A")])
def test_a_sign_against_the_voltage_of_a_bench_is_named(column, words, init, bench):
    _, out, _, _ = init({**bench, column: -bench[column]}, *settings(winding_resistance_ohm=R, torque_constant_N_m_A=K))
    (check,) = checks(out)
    assert check.startswith(f"{words}: the motor")
    assert check.endswith(f"against its voltage; give {words} or u_cmd_V factor: -1")


@pytest.mark.parametrize("both", [False, True])
def test_readings_without_a_sign_at_voltages_of_both_signs_are_named(both, init, bench):
    """A shunt measures |I|, and one channel of an encoder |w|."""
    names = ["current [A]", "speed [rad/s]"][: 1 + both]
    signed = {name: np.concatenate([values, -values]) for name, values in bench.items()}
    known = settings(winding_resistance_ohm=R, torque_constant_N_m_A=K)
    _, out, _, _ = init(signed, *known)
    assert checks(out) == []
    _, out, _, _ = init({**signed, **{name: np.abs(signed[name]) for name in names}}, *known, "--out", "unsigned")
    texts = checks(out)
    assert [text.split(":")[0] for text in texts] == ["omega_rad_s", "current_A"][1 - both :]
    assert all("is never below 0, although the voltage is in 24 of 48 rows" in text for text in texts)


@pytest.mark.parametrize(("below", "words"), [(0, "never below 0"), (2, "almost never below 0, in 2 of 120 rows")])
def test_a_reading_without_a_sign_at_mostly_negative_voltages_has_one_check(below, words, init, bench):
    """It seems to go against the voltage; a factor of -1 would make it worse. Noise takes a few rows below 0."""
    signed = {name: np.concatenate([values, *[-values] * 4]) for name, values in bench.items()}
    unsigned = {**signed, "speed [rad/s]": np.abs(signed["speed [rad/s]"])}
    unsigned["speed [rad/s]"][:below] = -0.01
    _, out, _, _ = init(unsigned, *settings(winding_resistance_ohm=R, torque_constant_N_m_A=K))
    (check,) = checks(out)
    assert check.startswith(f"omega_rad_s: it is {words}, although the voltage is in 96 of 120 rows")


def test_a_reading_against_the_voltage_that_is_seldom_above_0_is_not_one_without_a_sign(init, bench):
    """Of 1212 rows, 12 have a voltage above 0, and only there the reading is below it."""
    signed = {name: np.concatenate([values[12:], *[-values] * 50]) for name, values in bench.items()}
    against = {**signed, "speed [rad/s]": -signed["speed [rad/s]"]}
    _, out, _, _ = init(against, *settings(winding_resistance_ohm=R, torque_constant_N_m_A=K))
    (check,) = checks(out)
    assert check.endswith("against its voltage; give omega_rad_s or u_cmd_V factor: -1")


@pytest.mark.parametrize(
    ("known", "check"),
    [
        ({"winding_resistance_ohm": 3000}, "winding_resistance_ohm: 3000 ohm, .*; if it is in mohm, write 3"),
        ({"rotor_inertia_kg_m2": 3}, "rotor_inertia_kg_m2: 3 kg m2, .*; if it is in g m2, write 0.003"),
        ({"supply_voltage_V": 7400}, "supply_voltage_V: 7400 V, .*; if it is in mV, write 7.4"),
        ({"torque_constant_N_m_A": 33}, r"torque_constant_N_m_A: the motor turns .*at most (0\.\d+) N m/A would fit"),
        (
            {"torque_constant_N_m_A": 0.0033},
            r"torque_constant_N_m_A: the motor turns 0.0.*about (0\.\d+) N m/A would",
        ),
        ({"winding_resistance_ohm": R, "torque_constant_N_m_A": K, "supply_voltage_V": 7.4}, ""),
    ],
)
def test_numbers_of_the_motors_of_a_drive_in_another_unit_are_named(known, check, init, columns):
    _, out, _, _ = init(columns, *settings(ticks_per_turn=TICKS, **known))
    assert len(checks(out)) == bool(check)
    if check:
        match = re.match(check, checks(out)[0])
        assert match
        # The voltage of a motor without friction would be K w, and that of this one is SLOPE w and a little more.
        assert all(K < float(constant) < 1.3 * SLOPE for constant in match.groups())


def test_a_torque_constant_in_mN_m_is_named_and_not_the_volts_that_are_right(init, bench):
    """Multiplied by 1000, the voltages would be 6 kV."""
    _, out, _, _ = init(bench, *settings(winding_resistance_ohm=R, torque_constant_N_m_A=1000 * K))
    (check,) = checks(out)
    assert check.startswith("torque_constant_N_m_A: the motor turns")
    assert "if it is in mN m/A, write 0.3" in check


def test_the_speed_of_the_shaft_of_a_motor_is_named_with_the_gear_ratio(init, bench):
    """A motor with a gear of 120 turns at 20 rad/s at the wheel, and 2400 rad/s, or 22900 rpm, before the gear."""
    bench["speed [rpm]"] = 30.0 / np.pi * 120.0 * bench.pop("speed [rad/s]")
    code, _, err, _ = init(bench, *settings(winding_resistance_ohm=R, torque_constant_N_m_A=K))
    assert code == 2
    assert "if it is the speed of the motor's shaft, divide it by the gear ratio" in err
    assert "factor: 0.00833 for a ratio of 120" in err
    assert "this looks like rpm" not in err


def motor_of(**numbers):
    spreads = {name: {"value": value, "tolerance": 0.0} for name, value in numbers.items() if name[-2:] != "_V"}
    return NominalMotor.model_validate({**numbers, **spreads})


def test_the_numbers_of_a_large_motor_that_fit_each_other_give_no_check():
    """Its dry friction takes 0.8 of 21 V, and the viscous one is 0.02 of the braking by its back-EMF."""
    large = motor_of(
        winding_resistance_ohm=0.51,
        torque_constant_N_m_A=4.84,
        viscous_friction_N_m_s_rad=0.87,
        coulomb_friction_N_m=7.9,
        supply_voltage_V=21.4,
    )
    assert list(number_checks(large)) == []


def test_a_motor_that_a_coasting_bridge_lets_turn_faster_gives_no_check():
    """With the bridge open in the off time, a motor without load follows the supply and not the mean voltage."""
    motor = motor_of(
        winding_resistance_ohm=R,
        torque_constant_N_m_A=K,
        viscous_friction_N_m_s_rad=B,
        coulomb_friction_N_m=TC,
        supply_voltage_V=6.0,
    )
    mean_V = np.linspace(0.6, 2.4, 24)
    assert list(speed_checks(motor, mean_V, 2.5 * mean_V / K, "u_left_V")) == []
