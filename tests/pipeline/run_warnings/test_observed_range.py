"""Warnings of runs that leave the range in which an effect was observed."""

import numpy as np

from configs.draw import draw_robot
from configs.loader import load_section
from configs.posterior.schema import MeasuredRange
from configs.schema.effect_range import EffectRange
from physics.effects.wheels_and_floor.turn_slip import TurnSlip
from pipeline.run_warnings.observed_range import range_warnings
from symolo.core.tables.time_series import Recording, TimeSeries, Trajectory

ROWS = 100


def recording(*, v_m_s=0.2, voltage_V=2.0, tof_m=(0.5, 8.19)):
    t_s = 0.05 * np.arange(ROWS)
    twist = np.stack([np.broadcast_to(v_m_s, ROWS), np.zeros(ROWS)], axis=1)
    trajectory = Trajectory(t_s, np.zeros((ROWS, 3)), twist, np.zeros(ROWS, dtype=np.int64))
    status = np.tile([0, 1], (ROWS, 1))
    return Recording(
        trajectory,
        (
            TimeSeries("voltage_V", "V", t_s, np.broadcast_to(voltage_V, (ROWS, 2)).copy()),
            TimeSeries("tof_m", "m", t_s, np.tile(tof_m, (ROWS, 1))),
            TimeSeries("tof_status", "1", t_s, status),
        ),
    )


def robot(*ranges):
    config = draw_robot(load_section("robot", "nominal"), 0, "test")[0]
    seen = tuple(EffectRange(effect=e, quantity=q, low=low, high=high) for e, q, low, high in ranges)
    slip = TurnSlip(coefficient_s2_m=0.1)
    return config.with_effect(slip).model_copy(update={"effect_ranges": seen})


def test_a_run_inside_the_range_gets_no_warning():
    assert range_warnings(robot(("turn_slip", "v_m_s", 0.1, 0.3)), recording()) == ()


def test_a_run_outside_the_range_is_named_with_its_share_and_its_values():
    """Of the 91 means over ten rows, those count that contain at least five rows of the first 30: 26."""
    speeds = np.where(np.arange(ROWS) < 30, 0.45, 0.2)
    (warning,) = range_warnings(robot(("turn_slip", "v_m_s", 0.1, 0.3)), recording(v_m_s=speeds))
    assert "turn_slip was observed for v_m_s from 0.1 to 0.3, and 29 % of this run is outside" in warning
    assert "between 0.325 and 0.45" in warning


def test_a_tenth_of_the_width_beyond_or_a_short_peak_does_not_count():
    speeds = np.where(np.arange(ROWS) == 50, 0.45, 0.3)
    assert range_warnings(robot(("turn_slip", "v_m_s", 0.1, 0.3)), recording(v_m_s=speeds)) == ()
    voltages = np.where(np.arange(ROWS) == 50, 5.0, 2.0)[:, None] * np.ones(2)
    assert range_warnings(robot(("turn_slip", "voltage_V", 0.0, 3.0)), recording(voltage_V=voltages)) == ()


def test_an_effect_that_the_robot_does_not_have_needs_no_range():
    assert range_warnings(robot(("supply_sag", "voltage_V", 0.0, 1.0)), recording()) == ()


def test_a_range_sensor_without_a_target_measures_nothing():
    assert range_warnings(robot(("turn_slip", "tof_m", 0.1, 1.0)), recording()) == ()


def test_a_run_begins_at_rest_and_may_come_too_near_to_a_wall():
    ranges = (("turn_slip", "v_m_s", 0.1, 0.3), ("turn_slip", "tof_m", 0.2, 1.0))
    (warning,) = range_warnings(robot(*ranges), recording(v_m_s=0.0, tof_m=(0.05, 8.19)))
    assert "for tof_m from 0.2 to 1, and 100 % of this run is outside" in warning


def test_a_run_beyond_what_was_measured_is_named_whatever_effects_the_robot_has():
    plain = draw_robot(load_section("robot", "nominal"), 0, "test")[0]
    measured = [
        MeasuredRange(covariate="u_cmd_V", quantity="voltage_V", low=0.5, high=1.5),
        MeasuredRange(covariate="t_s", quantity=None, low=0.0, high=1.0),
    ]
    (warning,) = range_warnings(plain, recording(voltage_V=2.0), measured)
    assert warning == (
        "the robot was measured for voltage_V from 0.5 to 1.5, and 100 % of this run is outside, between 2 and 2: there"
        " its numbers are extrapolated"
    )
    assert range_warnings(plain, recording(voltage_V=1.55), measured) == ()
