"""Windings that change with time or heat, and friction that depends on the last change of the voltage, by hand."""

from pathlib import Path

import numpy as np
import pytest

from configs.effects.base import Slot
from configs.effects.registry import EFFECTS
from physics.drivetrain.motion import voltage_trend
from physics.drivetrain.motor_bench import steady_states, step_responses
from physics.robot.model import RobotModel
from physics.twin import KinematicTwin
from pipeline.effects.template import template

R, K, B, TC, J = 3.0, 0.3, 0.002, 0.02, 2e-3
STICKY = '''"""More friction after a fall of the voltage."""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
from physics.drivetrain.motion import ShaftMotion
from symolo.core.arrays import Array


class Sticky(Effect):
    slot = Slot.FRICTION
    cause = "a brush that turns over"
    excitation = "rising and falling voltages"
    setups = (Setup.MOTOR_BENCH, Setup.DRIVE)

    more_N_m: Annotated[float, Parameter("N m", null=0.0, start=0.01, low=-0.1, high=0.1)]
    """Change after a fall."""

    def apply(self, friction_N_m: Array, motion: ShaftMotion) -> Array:
        return friction_N_m + np.where(motion.trend < 0.0, self.more_N_m, 0.0)
'''


@pytest.fixture(scope="module")
def model_with(motor):
    def make(text, **numbers):
        effect = EFFECTS.executed(Path("law.py"), text.encode())
        return RobotModel.from_config(motor.with_effect(effect(**numbers)))

    return make


def by_hand(volts, resistance=R, constant=K, friction=TC):
    """Current [A] and speed [rad/s] of a motor that turns forwards: u = R I + K w and K I = B w + Tc."""
    speed = (constant * volts / resistance - friction) / (constant**2 / resistance + B)
    return (volts - constant * speed) / resistance, speed


def test_a_resistance_that_grows(model_with):
    model = model_with(template("loose_plug", Slot.RESISTANCE), rise_per_s=1e-3)
    states = steady_states(model, np.array([4.0, 4.0]), np.array([0.0, 300.0]))
    np.testing.assert_allclose(np.transpose(states), [by_hand(4.0), by_hand(4.0, resistance=1.3 * R)], rtol=1e-9)


def test_a_torque_constant_that_falls_in_torque_and_back_emf(model_with):
    model = model_with(template("weak_magnet", Slot.TORQUE_CONSTANT), loss_per_s=1e-3)
    expected = by_hand(4.0, constant=K / 1.3)
    current, speed = steady_states(model, np.array([4.0]), np.array([300.0]))
    np.testing.assert_allclose((current[0], speed[0]), expected, rtol=1e-9)
    # From rest, within two seconds, to the same state.
    current, speed = step_responses(model, np.full((400, 1), 4.0), 0.005, np.array([298.0]))
    np.testing.assert_allclose((current[-1, 0], speed[-1, 0]), expected, rtol=1e-3)


def test_a_winding_that_gets_warm(model_with):
    """A row holds until the next one. Time constant 60 s: after 60 s at 4 V the share is (1 - 1/e) 16 rise."""
    model = model_with(template("warm_copper", Slot.WINDING_HEAT), rise_per_V2=0.02)
    warm = 1.0 + 0.02 * 16.0 * (1.0 - np.exp(-1.0))
    cooled = 1.0 + 0.02 * 16.0 * (1.0 - np.exp(-1.0)) * np.exp(-0.5)
    volts, time_s = np.array([4.0, 0.0, 2.0]), np.array([0.0, 60.0, 90.0])
    current, speed = steady_states(model, volts, time_s)
    assert current[1] == speed[1] == 0.0
    np.testing.assert_allclose((current[0], speed[0]), by_hand(4.0), rtol=1e-9)
    np.testing.assert_allclose((current[2], speed[2]), by_hand(2.0, cooled * R), rtol=1e-9)
    # The order of the rows in time counts, and not that in the arrays.
    again = steady_states(model, volts[::-1], time_s[::-1])
    np.testing.assert_array_equal(np.array(again)[:, ::-1], (current, speed))
    # The same in steps of 0.1 s.
    current, speed = step_responses(model, np.full((600, 1), 4.0), 0.1)
    np.testing.assert_allclose((current[-1, 0], speed[-1, 0]), by_hand(4.0, warm * R), rtol=2e-3)


def test_friction_after_a_fall_of_the_voltage(model_with):
    model = model_with(STICKY, more_N_m=0.01)
    volts = np.array([2.0, 4.0, 4.0, 3.0, 4.0])
    _, speed = steady_states(model, volts, np.arange(5.0))
    expected = [by_hand(u, friction=TC + more)[1] for u, more in zip(volts, (0, 0, 0, 0.01, 0), strict=True)]
    np.testing.assert_allclose(speed, expected, rtol=1e-9)
    # A trial that falls from 4 V to 3 V ends where the row does.
    _, speed = step_responses(model, np.repeat([4.0, 3.0], 400)[:, None], 0.005)
    np.testing.assert_allclose(speed[[399, -1], 0], expected[1:4:2], rtol=1e-4)


def test_the_twin_has_the_same_friction_and_the_same_heat(model_with):
    """On a robot, less speed is left by the same changes."""
    volts = np.repeat([4.0, 3.0], 100)[:, None, None] * np.ones(2)
    bare = KinematicTwin(model_with(STICKY, more_N_m=0.0)).drive(volts, np.zeros((1, 3))).wheel_speed_rad_s
    sticky = KinematicTwin(model_with(STICKY, more_N_m=0.01)).drive(volts, np.zeros((1, 3))).wheel_speed_rad_s
    np.testing.assert_array_equal(sticky[:101], bare[:101])
    slower = (bare - sticky)[-1]
    # Both wheels lose 0.01 N m of torque, over the loss of torque per unit of speed.
    np.testing.assert_allclose(slower, 0.01 / (K**2 / R + B), rtol=0.02)


def test_the_trend_of_a_voltage():
    volts = np.array([0.0, 2.0, 1.0, 1.0, -3.0, np.nan, -1.0, 1.0])
    np.testing.assert_array_equal(voltage_trend(volts), [1.0, 1.0, -1.0, -1.0, 1.0, 1.0, -1.0, -1.0])
