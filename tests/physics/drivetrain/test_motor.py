import math

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from configs.schema.robot import Motor
from physics.drivetrain.motor import MotorModel, Motors

MOTOR = MotorModel(
    resistance_ohm=2.85,
    torque_constant_N_m_A=0.31,
    viscous_N_m_s_rad=0.0027,
    coulomb_N_m=0.0174,
    inertia_kg_m2=1e-3,
)
BREAKAWAY_V = 2.85 * 0.0174 / 0.31


def integrate(voltage: float, speed: float, duration: float, pieces: int) -> tuple[float, float]:
    """An independent fine explicit integration of Eq. 18, with friction that stops a wheel and never turns it."""
    dt, angle = duration / pieces, 0.0
    for _ in range(pieces):
        drive = 0.31 * (voltage - 0.31 * speed) / 2.85 - 0.0027 * speed
        free = speed + dt * drive / 1e-3
        limit = dt * 0.0174 / 1e-3
        new = math.copysign(max(abs(free) - limit, 0.0), free)
        angle += 0.5 * dt * (speed + new)
        speed = new
    return speed, angle


def test_steady_state_satisfies_both_equations_of_eq_21():
    for voltage in (-6.0, -1.0, 0.5, 3.0, 6.0):
        current, speed = MOTOR.steady_state(voltage)
        assert voltage == pytest.approx(2.85 * current + 0.31 * speed, abs=1e-12)
        assert 0.31 * current - 0.0027 * speed - math.copysign(0.0174, voltage) == pytest.approx(0.0, abs=1e-12)


def test_current_is_that_of_voltage_less_back_emf_through_the_winding():
    assert MOTOR.current_A(3.0, 4.0) == pytest.approx((3.0 - 0.31 * 4.0) / 2.85)


@pytest.mark.parametrize("share", [-0.999, -0.5, 0.0, 0.5, 0.999])
def test_a_stuck_wheel_stays_stuck_to_the_last_bit_below_breakaway(share):
    voltage = share * BREAKAWAY_V
    assert MOTOR.steady_state(voltage) == (pytest.approx(voltage / 2.85), 0.0)
    assert MOTOR.step(voltage, 0.0, 3600.0) == (0.0, 0.0)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_wheel_moves_just_above_breakaway(sign):
    speed, angle = MOTOR.step(sign * 1.001 * BREAKAWAY_V, 0.0, 1.0)
    assert sign * speed > 0.0
    assert sign * angle > 0.0


def test_friction_brings_a_coasting_wheel_to_rest_in_the_closed_form_time_and_never_turns_it_round():
    damping = 0.31**2 / 2.85 + 0.0027
    stops_after = 1e-3 / damping * math.log(1.0 + damping * 5.0 / 0.0174)
    assert MOTOR.step(0.0, 5.0, 0.999 * stops_after)[0] > 0.0
    assert MOTOR.step(0.0, 5.0, 1.001 * stops_after)[0] == 0.0
    assert MOTOR.step(0.0, 5.0, 100.0) == MOTOR.step(0.0, 5.0, 1.001 * stops_after)


def test_eq_20_settles_with_its_mechanical_time_constant():
    _, final = MOTOR.steady_state(4.0)
    time_constant = 2.85 * (1e-3 + 5e-4) / (0.31**2 + 2.85 * 0.0027)
    speed, _ = MOTOR.step(4.0, 0.0, time_constant, load_inertia_kg_m2=5e-4)
    assert speed == pytest.approx((1.0 - math.exp(-1.0)) * final, rel=1e-12)


@given(
    voltage=st.floats(-6, 6),
    speed=st.floats(-20, 20),
    duration=st.floats(1e-3, 0.3),
    share=st.floats(0.05, 0.95),
)
@example(voltage=0.0, speed=5e-324, duration=0.25, share=0.5)
def test_two_short_steps_make_one_long_one(voltage, speed, duration, share):
    halfway, turned = MOTOR.step(voltage, speed, share * duration)
    end, further = MOTOR.step(voltage, halfway, (1.0 - share) * duration)
    whole_speed, whole_angle = MOTOR.step(voltage, speed, duration)
    assert end == pytest.approx(whole_speed, abs=1e-9)
    assert turned + further == pytest.approx(whole_angle, abs=1e-9)


@pytest.mark.parametrize(
    ("voltage", "speed"), [(3.0, 0.0), (0.1, 8.0), (-2.0, 6.0), (2.0, -6.0), (-0.1, -3.0), (6.0, 19.0)]
)
def test_the_exact_step_agrees_with_fine_integration(voltage, speed):
    expected_speed, expected_angle = integrate(voltage, speed, 0.2, 100_000)
    found_speed, found_angle = MOTOR.step(voltage, speed, 0.2)
    assert found_speed == pytest.approx(expected_speed, abs=2e-4)
    assert found_angle == pytest.approx(expected_angle, abs=2e-4)


def test_a_model_has_the_numbers_of_its_description():
    config = Motor(
        winding_resistance_ohm=2.85,
        torque_constant_N_m_A=0.31,
        viscous_friction_N_m_s_rad=0.0027,
        coulomb_friction_N_m=0.0174,
        rotor_inertia_kg_m2=1e-3,
    )
    assert MotorModel.from_config(config) == MOTOR


def test_a_change_of_each_motor_keeps_right_and_left_apart():
    weak = MotorModel(5.0, 0.1, 0.0, 0.0, 1e-3)
    doubled = Motors(MOTOR, weak).each(lambda motor: MotorModel(2 * motor.resistance_ohm, 0.1, 0.0, 0.0, 1e-3))
    assert (doubled.right.resistance_ohm, doubled.left.resistance_ohm) == (5.7, 10.0)


def test_motors_cannot_be_changed(changeable):
    for kind in (MotorModel, Motors):
        assert changeable(kind) == []
