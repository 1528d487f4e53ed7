"""Experiments with the motor against the paper's tables and closed forms, on motors with planted numbers."""

import math
from pathlib import Path

import numpy as np
import pytest
import yaml

from configs.schema.robot import RobotConfig
from diagnosis.motor_identification import TABLE_2
from diagnosis.validation.measures import rms
from diagnosis.validation.motor.energy import energy
from diagnosis.validation.motor.experiments import require_inertia
from diagnosis.validation.motor.steady_states import largest, steady_states
from diagnosis.validation.motor.steps import steps
from diagnosis.validation.motor.stiction import starts_and_reversals, stiction
from physics.effects.driver_and_battery.input_delay import InputDelay
from physics.effects.motor_and_gearbox.stribeck_friction import StribeckFriction
from symolo.core.errors import InputError

NOMINAL = Path(__file__).parents[3] / "configs" / "robots" / "nominal.yaml"
R, K, B, TQ, J = 4.0, 0.25, 0.003, 0.02, 2e-3
TAU_S = R * J / (K**2 + R * B)
BREAKAWAY_V = R * TQ / K


@pytest.fixture(scope="module")
def nominal():
    return RobotConfig.model_validate(yaml.safe_load(NOMINAL.read_text(encoding="utf-8")))


@pytest.fixture(scope="module")
def planted(nominal):
    numbers = {
        "winding_resistance_ohm": R,
        "torque_constant_N_m_A": K,
        "viscous_friction_N_m_s_rad": B,
        "coulomb_friction_N_m": TQ,
        "rotor_inertia_kg_m2": J,
    }
    return nominal.model_copy(update={"motor": nominal.motor.model_copy(update=numbers)})


@pytest.fixture(scope="module")
def steady(nominal):
    return steady_states(nominal, 1).tables


@pytest.fixture(scope="module")
def stuck(planted):
    return stiction(planted, 1)


@pytest.fixture(scope="module")
def work(planted):
    return energy(planted, 1)


def test_table_1_is_shown_as_printed(steady):
    table = steady["table_1"]
    rows = list(zip(table["voltage_V"], table["current_A"], table["speed_rad_s"], strict=True))
    assert len(rows) == 21
    assert rows[1] == (0.25, 0.072723, 0.0)
    assert rows[-1] == (5.0, 0.178680, 14.318)


def test_the_variant_is_the_one_that_rounds_to_the_printed_table_2(steady):
    variant = [steady["variant that gives Table 2"][name] for name in vars(TABLE_2)]
    assert [round(value, digits) for value, digits in zip(variant, (2, 2, 3, 2), strict=True)] == [
        3.03,
        0.31,
        0.002,
        0.02,
    ]
    assert vars(TABLE_2).items() <= steady["Table 2 as printed"].items()


def test_table_2_as_printed_is_11_percent_low_in_current_at_5_V(steady):
    assert steady["Table 2 as printed"]["current_residual_A"][-1] / 0.178680 == pytest.approx(-0.11, abs=0.005)


def test_the_nominal_robot_is_the_literal_fit(steady):
    robot, fit = steady["robot"], steady["fit of Eq. 21-22 as written"]
    np.testing.assert_allclose(robot["current_A"], fit["current_A"], atol=1e-7)
    np.testing.assert_allclose(robot["speed_rad_s"], fit["speed_rad_s"], atol=1e-6)


def test_every_candidate_satisfies_eq_21_where_it_moves(steady):
    for name in ("fit of Eq. 21-22 as written", "variant that gives Table 2", "Table 2 as printed"):
        r, k, b, tq = (steady[name][parameter] for parameter in vars(TABLE_2))
        u, i, w = steady["table_1"]["voltage_V"][2:], steady[name]["current_A"][2:], steady[name]["speed_rad_s"][2:]
        np.testing.assert_allclose(r * i + k * w, u)
        np.testing.assert_allclose(k * i, b * w + tq)


def test_residuals_are_model_less_measurement(steady):
    residual = steady["robot"]["speed_rad_s"] - steady["table_1"]["speed_rad_s"]
    assert steady["robot"]["speed_residual_rad_s"].tolist() == residual.tolist()
    assert rms(np.array([0.0, -3.0, 4.0])) == pytest.approx(math.sqrt(25.0 / 3.0))
    assert largest(np.array([0.0, -3.0, 4.0])) == 4.0
    assert largest(np.array([0.0, -5.0, 4.0])) == -5.0


def test_a_step_rises_with_the_time_constant_of_eq_20(planted):
    result = steps(planted, 1)
    closed, *responses = result.tables.values()
    assert closed["time_constant_s"] == pytest.approx(TAU_S, rel=1e-12)
    assert [response["voltage_V"] for response in responses] == [1.5, 3.0, 4.5, 6.0]
    assert all(check.passed for check in result.checks)
    for response in responses:
        assert response["time_to_63_percent_s"] == pytest.approx(TAU_S, rel=1e-3)
        assert response["rise_10_90_percent_s"] == pytest.approx(math.log(9.0) * TAU_S, rel=1e-3)
        settled = (K * response["voltage_V"] / R - TQ) / (K**2 / R + B)
        assert response["settled_rad_s"] == pytest.approx(settled)
        speed = settled * (1.0 - np.exp(-response["time_s"] / TAU_S))
        np.testing.assert_allclose(response["speed_rad_s"], speed, rtol=1e-9)
        np.testing.assert_allclose(response["current_A"], (response["voltage_V"] - K * speed) / R, rtol=1e-9)


def test_an_input_delay_shifts_the_step_and_leaves_its_rise(planted):
    delayed = planted.with_effect(InputDelay(delay_s=0.02))
    result = steps(delayed, 1)
    response = list(result.tables.values())[-1]
    assert response["time_to_63_percent_s"] == pytest.approx(TAU_S + 0.02, abs=0.0005)
    assert response["rise_10_90_percent_s"] == pytest.approx(math.log(9.0) * TAU_S, rel=1e-3)
    # The closed forms are those of a motor without effects, so that this robot is not held to them.
    assert {check.passed for check in result.checks} == {None}


def test_a_wheel_that_is_stuck_has_no_rise(planted):
    weak = planted.model_copy(update={"power": planted.power.model_copy(update={"motor_voltage_limit_V": 0.2})})
    responses = list(steps(weak, 1).tables.values())[1:]
    assert all(math.isnan(response["rise_10_90_percent_s"]) for response in responses)
    assert {speed for response in responses for speed in response["speed_rad_s"].tolist()} == {0.0}


def test_a_wheel_breaks_away_and_stops_where_friction_says(stuck):
    breaks, stops, ramp = stuck.check("breaks away at"), stuck.check("comes to rest at"), stuck.tables["ramp"]
    assert breaks.expected == pytest.approx(BREAKAWAY_V)
    assert breaks.value == pytest.approx(BREAKAWAY_V, abs=2 * ramp["resolution_V"])
    assert breaks.value > BREAKAWAY_V
    # The speed follows the falling voltage a time constant late.
    assert stops.value == pytest.approx(BREAKAWAY_V - ramp["ramp_V_s"] * TAU_S, abs=2 * ramp["resolution_V"])
    assert all(check.passed for check in stuck.checks)


def test_a_wheel_below_breakaway_is_exactly_at_rest_and_does_not_chatter(stuck):
    assert max(stuck.tables["held_below_breakaway"]["voltage_V"]) == pytest.approx(0.999 * BREAKAWAY_V)
    assert stuck.check("fastest wheel below breakaway").value == 0.0
    assert [stuck.check(name).value for name in ("starts from rest", "reversals")] == [2, 1]
    speed, voltage = stuck.tables["ramp"]["speed_rad_s"], stuck.tables["ramp"]["voltage_V"]
    falling = slice(len(speed) // 4 + 1, 3 * len(speed) // 4)
    between = np.abs(voltage[falling]) < 0.9 * stuck.check("comes to rest at").value
    assert between.sum() > 50
    assert set(speed[falling][between]) == {0.0}


def test_more_friction_at_rest_delays_the_breakaway_but_not_as_much_the_stop(planted):
    effect = StribeckFriction(extra_torque_N_m=0.004, stribeck_speed_rad_s=1.0)
    sticky = stiction(planted.with_effect(effect), 1)
    breaks_V, stops_V = (sticky.check(name).value for name in ("breaks away at", "comes to rest at"))
    assert breaks_V == pytest.approx(R * (TQ + 0.004) / K, abs=2 * sticky.tables["ramp"]["resolution_V"])
    assert stops_V < breaks_V


def test_a_motor_without_dry_friction_turns_at_any_voltage(planted):
    free = planted.model_copy(update={"motor": planted.motor.model_copy(update={"coulomb_friction_N_m": 0.0})})
    result = stiction(free, 1)
    ramp = result.tables["ramp"]
    assert result.check("breaks away at").value == pytest.approx(ramp["resolution_V"])
    stops_V = result.check("comes to rest at").value
    assert stops_V == pytest.approx(-ramp["ramp_V_s"] * TAU_S, abs=2 * ramp["resolution_V"])


def test_chatter_would_be_counted():
    assert starts_and_reversals(np.array([0.0, 0.0, 1.0, 2.0, 0.0, 0.0])) == (1, 0)
    assert starts_and_reversals(np.array([0.0, 1.0, 0.0, -1.0, 1.0, 0.0, 1.0])) == (3, 2)


def test_electrical_work_is_heat_and_kinetic_energy(work):
    sums = work.tables["sums"]
    assert work.check("largest imbalance").value < 1e-6 * sums["throughput_J"]
    assert sums["lowest_friction_heat_of_a_row_J"] >= 0.0
    assert min(np.diff(sums["winding_J"])) >= 0.0
    assert all(check.passed for check in work.checks)


def test_the_heat_of_the_winding_in_a_run_up_is_that_of_the_closed_form(work):
    """Run up for eight time constants: i = i_end + (u / R - i_end) exp(-t / tau), squared and integrated."""
    settled = (K * 6.0 / R - TQ) / (K**2 / R + B)
    last, more, ends_s = (6.0 - K * settled) / R, K * settled / R, 8 * TAU_S
    integral = (
        last**2 * ends_s
        + 2 * last * more * TAU_S * (1 - math.exp(-ends_s / TAU_S))
        + 0.5 * more**2 * TAU_S * (1 - math.exp(-2 * ends_s / TAU_S))
    )
    sums = work.tables["sums"]
    row = int(np.argmin(np.abs(sums["time_s"] - ends_s)))
    assert sums["winding_J"][row] == pytest.approx(R * integral, rel=1e-6)
    assert sums["kinetic_J"][row] == pytest.approx(0.5 * J * settled**2, rel=1e-3)


def test_a_motor_without_inertia_is_refused(nominal):
    require_inertia(nominal)
    rotorless = nominal.motor.model_copy(update={"rotor_inertia_kg_m2": 0.0})
    with pytest.raises(InputError, match="rotor_inertia_kg_m2"):
        require_inertia(nominal.model_copy(update={"motor": rotorless}))
