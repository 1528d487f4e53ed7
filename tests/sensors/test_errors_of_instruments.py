"""What instruments add to a reading over time, and a ripple of a speed over the angle, by closed form."""

from pathlib import Path

import numpy as np

from configs.effects.base import Slot
from configs.effects.registry import EFFECTS
from configs.effects.robot_effects import RobotEffects
from pipeline.effects.template import template
from sensors.wheels.instruments import read_current_A, read_settled_speed_rad_s, read_speed_rad_s

T_S = 0.01 * np.arange(1, 301)
HUM = np.sin(44.0 * T_S + 0.5)[:, None]


def effects_in(slot, **numbers):
    effect = EFFECTS.executed(Path("law.py"), template("strange", slot).encode())
    return RobotEffects().with_effect(effect(**numbers))


def test_a_hum_is_added_to_current_and_speed():
    current, speed = np.full((300, 2), 0.7), np.full((300, 2), 5.0)
    humming = effects_in(Slot.CURRENT_ERROR, swing_A=0.02)
    np.testing.assert_allclose(read_current_A(humming, current, T_S[:, None]) - 0.7, 0.02 * np.hstack([HUM, HUM]))
    humming = effects_in(Slot.SPEED_ERROR, swing_rad_s=0.3)
    np.testing.assert_allclose(read_speed_rad_s(humming, T_S, speed) - 5.0, 0.3 * np.hstack([HUM, HUM]))
    np.testing.assert_allclose(read_settled_speed_rad_s(humming, speed[:, 0], T_S) - 5.0, 0.3 * HUM[:, 0])


def test_a_ripple_over_the_angle_of_a_speed_that_rises_in_proportion_to_time():
    """The angle of w = a t is a t^2 / 2, from time 0 on, where the log has no row yet."""
    ripple = effects_in(Slot.SPEED_RIPPLE, swing=0.1)
    found = read_speed_rad_s(ripple, T_S, np.stack([4.0 * T_S, -2.0 * T_S], axis=1))
    expected = [a * T_S * (1.0 + 0.1 * np.sin(a * T_S**2)) for a in (4.0, -2.0)]
    np.testing.assert_allclose(found, np.transpose(expected), rtol=1e-9)


def test_a_settled_speed_is_a_mean_over_turns_without_ripple():
    ripple = effects_in(Slot.SPEED_RIPPLE, swing=0.1)
    np.testing.assert_array_equal(read_settled_speed_rad_s(ripple, T_S, T_S), T_S)
