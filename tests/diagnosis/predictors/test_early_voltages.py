import numpy as np
import pytest

from diagnosis.measured.zero_order_hold import held_means
from diagnosis.predictors.wheels.early_voltages import SHAPES, held_earlier, independent_responses, shaped, steps_s
from physics.drivetrain.motor import MotorModel
from symolo.core.tables.time_series import TimeSeries

MOTOR = MotorModel(
    resistance_ohm=4.0, torque_constant_N_m_A=0.3, viscous_N_m_s_rad=0.002, coulomb_N_m=0.0, inertia_kg_m2=0.003
)
ROW_S, STEPS = 0.05, 5000


def mean_speeds(voltage_V):
    """Return the mean speed of the motor in each row with a voltage for each row, by the midpoint rule."""
    step_s, speed, means = ROW_S / STEPS, 0.0, []
    slope = (0.3**2 / 4.0 + 0.002) / 0.003
    for volts in voltage_V:
        turned = 0.0
        for _ in range(STEPS):
            half = speed + 0.5 * step_s * (0.3 * volts / 4.0 / 0.003 - slope * speed)
            speed += step_s * (0.3 * volts / 4.0 / 0.003 - slope * half)
            turned += half * step_s
        means.append(turned / ROW_S)
    return np.array(means)


def test_the_responses_to_independent_voltages_add_up_as_variances():
    steps_V = np.array([0.0, 1.0, -2.0, 0.0, 0.0])
    alone = [mean_speeds(np.where(np.arange(5) == k, steps_V, 0.0)) for k in (1, 2)]
    scatter = independent_responses(MOTOR, MOTOR.inertia_kg_m2, steps_V[:, None], ROW_S)
    assert scatter[:, 0] == pytest.approx(np.hypot(*alone), rel=1e-6)


def test_a_motor_without_inertia_follows_at_once():
    scatter = independent_responses(MOTOR, 0.0, np.array([[2.0], [0.0]]), ROW_S)
    final = 0.3 * 2.0 / 4.0 / (0.3**2 / 4.0 + 0.002)
    assert scatter[:, 0] == pytest.approx([final, 0.0], abs=1e-4)


@pytest.mark.parametrize(
    ("shape", "means"), [(SHAPES[0], [1.0, 3.0]), (SHAPES[1], [2.0, 2.5]), (SHAPES[2], [3.0, 2.0])]
)
def test_a_change_acts_not_by_half_or_wholly_in_the_row_before_it(shape, means):
    voltage_V = np.array([1.0, 3.0, 2.0])
    assert shaped(voltage_V, shape).reshape(2, -1).mean(axis=1) == pytest.approx(means)
    series = TimeSeries("u_left_V", "V", np.array([0.0, ROW_S, 2 * ROW_S]), voltage_V)
    earlier = held_earlier(series, shape)
    begins_s = np.array([0.0, ROW_S])
    assert held_means(earlier.t_s, earlier.values, begins_s, ROW_S) == pytest.approx(means, abs=1e-4)


def test_a_value_that_never_changes_stays_as_it_is():
    series = TimeSeries("u_left_V", "V", np.array([0.0]), np.array([3.0]))
    assert held_earlier(series, SHAPES[1]).values.tolist() == [3.0]


def test_a_change_acts_about_a_row_early_though_rows_are_irregular_or_a_value_is_held_for_several():
    """Rows are 24 to 36 ms apart, and the voltage changes in three of four; no change overtakes another."""
    rng = np.random.Generator(np.random.PCG64(1))
    t_s = 0.03 * np.arange(400) + rng.uniform(-0.006, 0.006, 400)
    changes = np.flatnonzero(rng.random(400) < 0.75)
    series = TimeSeries("u_left_V", "V", t_s[changes], rng.uniform(-3.0, 3.0, len(changes)))
    steps = steps_s(series)
    assert np.median(steps) == pytest.approx(0.03, rel=0.15)
    assert np.all(np.diff(held_earlier(series, SHAPES[2]).t_s) > 0.0)
