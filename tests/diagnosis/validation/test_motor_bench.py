"""The motor bench against the paper's tables and closed forms, on motors with numbers of their own."""

import math
from dataclasses import astuple
from pathlib import Path

import numpy as np
import pytest
import yaml

from configs.schema.robot import RobotConfig
from diagnosis.motor_identification import TABLE_2
from diagnosis.validation.motor.bench import check_motor
from diagnosis.validation.motor.energy import energy_bench
from diagnosis.validation.motor.steady_states import Residuals, steady_bench
from diagnosis.validation.motor.steps import step_bench
from diagnosis.validation.motor.stiction import starts_and_reversals, stiction_bench
from physics.drivetrain.motor import MotorModel
from physics.effects.input_delay import InputDelay
from physics.effects.stribeck_friction import StribeckFriction
from physics.robot.model import RobotModel
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
    return steady_bench(RobotModel.from_config(nominal))


@pytest.fixture(scope="module")
def stiction(planted):
    return stiction_bench(RobotModel.from_config(planted))


@pytest.fixture(scope="module")
def energy():
    return energy_bench(MotorModel(R, K, B, TQ, J), 6.0)


def test_table_1_is_shown_as_printed(steady):
    assert len(steady.voltage_V) == 21
    rows = list(zip(steady.voltage_V, steady.measured_current_A, steady.measured_speed_rad_s, strict=True))
    assert rows[1] == (0.25, 0.072723, 0.0)
    assert rows[-1] == (5.0, 0.178680, 14.318)


def test_the_variant_is_the_one_that_rounds_to_the_printed_table_2(steady):
    found = [
        round(value, digits)
        for value, digits in zip(astuple(steady.printed_variant.parameters), (2, 2, 3, 2), strict=True)
    ]
    assert found == [3.03, 0.31, 0.002, 0.02]
    assert steady.table_2.parameters == TABLE_2


def test_table_2_as_printed_is_11_percent_low_in_current_at_5_V(steady):
    assert steady.table_2.current_residual_A.by_row[-1] / 0.178680 == pytest.approx(-0.11, abs=0.005)


def test_the_nominal_robot_is_the_literal_fit(steady):
    np.testing.assert_allclose(steady.robot.current_A, steady.literal_fit.current_A, atol=1e-7)
    np.testing.assert_allclose(steady.robot.speed_rad_s, steady.literal_fit.speed_rad_s, atol=1e-6)


def test_every_candidate_satisfies_eq_21_where_it_moves(steady):
    for found in (steady.literal_fit, steady.printed_variant, steady.table_2):
        of = found.parameters
        u, i, w = (np.array(values)[2:] for values in (steady.voltage_V, found.current_A, found.speed_rad_s))
        np.testing.assert_allclose(of.winding_resistance_ohm * i + of.torque_constant_N_m_A * w, u)
        np.testing.assert_allclose(
            of.torque_constant_N_m_A * i, of.viscous_friction_N_m_s_rad * w + of.coulomb_friction_N_m
        )


def test_residuals_are_model_less_measurement():
    found = Residuals.of(np.array([1.0, 2.0, 0.0]), np.array([1.0, 5.0, -4.0]))
    assert found.by_row == (0.0, -3.0, 4.0)
    assert found.rms == pytest.approx(math.sqrt(25.0 / 3.0))
    assert found.largest == 4.0


def test_a_step_rises_with_the_time_constant_of_eq_20(planted):
    bench = step_bench(RobotModel.from_config(planted))
    assert bench.time_constant_s == pytest.approx(TAU_S, rel=1e-12)
    assert [response.voltage_V for response in bench.responses] == [1.5, 3.0, 4.5, 6.0]
    for response in bench.responses:
        assert response.time_to_63_percent_s == pytest.approx(TAU_S, rel=1e-3)
        assert response.rise_10_90_percent_s == pytest.approx(math.log(9.0) * TAU_S, rel=1e-3)
        settled = (K * response.voltage_V / R - TQ) / (K**2 / R + B)
        assert response.settled_rad_s == pytest.approx(settled)
        time = np.array(response.time_s)
        np.testing.assert_allclose(response.speed_rad_s, settled * (1.0 - np.exp(-time / TAU_S)), rtol=1e-9)
        np.testing.assert_allclose(
            response.current_A, (response.voltage_V - K * np.array(response.speed_rad_s)) / R, rtol=1e-9
        )


def test_an_input_delay_shifts_the_step_and_leaves_its_rise(planted):
    delayed = planted.with_effect(InputDelay(delay_s=0.02))
    response = step_bench(RobotModel.from_config(delayed)).responses[-1]
    assert response.time_to_63_percent_s == pytest.approx(TAU_S + 0.02, abs=0.0005)
    assert response.rise_10_90_percent_s == pytest.approx(math.log(9.0) * TAU_S, rel=1e-3)


def test_a_wheel_that_is_stuck_has_no_rise(planted):
    weak = planted.model_copy(update={"power": planted.power.model_copy(update={"motor_voltage_limit_V": 0.2})})
    responses = step_bench(RobotModel.from_config(weak)).responses
    assert {response.rise_10_90_percent_s for response in responses} == {None}
    assert {speed for response in responses for speed in response.speed_rad_s} == {0.0}


def test_a_wheel_breaks_away_and_stops_where_friction_says(stiction):
    assert stiction.breakaway_closed_form_V == pytest.approx(BREAKAWAY_V)
    assert stiction.breakaway_V == pytest.approx(BREAKAWAY_V, abs=2 * stiction.resolution_V)
    assert stiction.breakaway_V > BREAKAWAY_V
    # The speed follows the falling voltage a time constant late.
    stops_V = BREAKAWAY_V - stiction.ramp_V_s * TAU_S
    assert stiction.stops_V == pytest.approx(stops_V, abs=2 * stiction.resolution_V)


def test_a_wheel_below_breakaway_is_exactly_at_rest_and_does_not_chatter(stiction):
    assert max(stiction.held_below_breakaway_V) == pytest.approx(0.999 * BREAKAWAY_V)
    assert stiction.fastest_held_rad_s == 0.0
    assert (stiction.starts, stiction.reversals) == (2, 1)
    speed, voltage = np.array(stiction.speed_rad_s), np.array(stiction.voltage_V)
    falling = slice(len(speed) // 4 + 1, 3 * len(speed) // 4)
    between = np.abs(voltage[falling]) < 0.9 * stiction.stops_V
    assert between.sum() > 50
    assert set(speed[falling][between]) == {0.0}


def test_more_friction_at_rest_delays_the_breakaway_but_not_as_much_the_stop(planted):
    effect = StribeckFriction(extra_torque_N_m=0.004, stribeck_speed_rad_s=1.0)
    sticky = stiction_bench(RobotModel.from_config(planted.with_effect(effect)))
    assert sticky.breakaway_V == pytest.approx(R * (TQ + 0.004) / K, abs=2 * sticky.resolution_V)
    assert sticky.stops_V < sticky.breakaway_V


def test_a_motor_without_dry_friction_turns_at_any_voltage(planted):
    free = planted.model_copy(update={"motor": planted.motor.model_copy(update={"coulomb_friction_N_m": 0.0})})
    found = stiction_bench(RobotModel.from_config(free))
    assert found.breakaway_V == pytest.approx(found.resolution_V)
    assert found.stops_V == pytest.approx(-found.ramp_V_s * TAU_S, abs=2 * found.resolution_V)


def test_chatter_would_be_counted():
    assert starts_and_reversals(np.array([0.0, 0.0, 1.0, 2.0, 0.0, 0.0])) == (1, 0)
    assert starts_and_reversals(np.array([0.0, 1.0, 0.0, -1.0, 1.0, 0.0, 1.0])) == (3, 2)


def test_electrical_work_is_heat_and_kinetic_energy(energy):
    assert energy.largest_imbalance_J < 1e-6 * energy.throughput_J
    assert energy.min_friction_heat_J >= 0.0
    assert min(np.diff(energy.winding_J)) >= 0.0


def test_the_heat_of_the_winding_in_a_run_up_is_that_of_the_closed_form(energy):
    """Run up for eight time constants: i = i_end + (u / R - i_end) exp(-t / tau), squared and integrated."""
    settled = (K * 6.0 / R - TQ) / (K**2 / R + B)
    last, more, ends_s = (6.0 - K * settled) / R, K * settled / R, 8 * TAU_S
    integral = (
        last**2 * ends_s
        + 2 * last * more * TAU_S * (1 - math.exp(-ends_s / TAU_S))
        + 0.5 * more**2 * TAU_S * (1 - math.exp(-2 * ends_s / TAU_S))
    )
    row = int(np.argmin(np.abs(np.array(energy.time_s) - ends_s)))
    assert energy.winding_J[row] == pytest.approx(R * integral, rel=1e-6)
    assert energy.kinetic_J[row] == pytest.approx(0.5 * J * settled**2, rel=1e-3)


def test_a_motor_without_inertia_is_refused(nominal):
    check_motor(nominal)
    rotorless = nominal.motor.model_copy(update={"rotor_inertia_kg_m2": 0.0})
    with pytest.raises(InputError, match="rotor_inertia_kg_m2"):
        check_motor(nominal.model_copy(update={"motor": rotorless}))
