"""Turns of wheels under the load of a body, which follow from its motion forward and around itself."""

from itertools import pairwise

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.loader import load_section
from physics.drivetrain.driveline import Driveline
from physics.drivetrain.held_rows import HeldVoltages
from physics.drivetrain.wheel_turns import WheelLoad, counted_turns
from physics.effects.driver_and_battery.actuator_lag import ActuatorLag
from physics.effects.driver_and_battery.bridge_coast import BridgeCoast
from physics.effects.driver_and_battery.current_limit import CurrentLimit
from physics.effects.driver_and_battery.input_delay import InputDelay
from physics.effects.driver_and_battery.supply_sag import SupplySag
from physics.robot.body_inertia import BodyOnWheels
from physics.robot.model import RobotModel
from physics.robot.stack import stacked

ROW_S, PARTS, ROWS = 0.05, 5, 8
OWN, OTHER = 6e-4, -6e-5
"""Inertia of a body for the acceleration of a wheel, and for that of the other one."""


@pytest.mark.parametrize(("right", "left"), [(1.0, 1.0), (1.0, -1.0)])
def test_a_body_is_easier_to_drive_forward_than_to_turn_if_its_wheels_are_coupled_so(right, left):
    """With both wheels at the same speed, or at opposite ones, each has the inertia of its own and that of the other.

    A motor with Coulomb friction then turns by w (t - T (1 - exp(-t / T))), with its last speed w and T = J / damping.
    """
    model = RobotModel.from_config(draw_robot(load_section("robot", "nominal"), 1, "test")[0])
    body = BodyOnWheels(np.zeros((2, 2)), np.array([[OWN, OTHER], [OTHER, OWN]]), 0.0, 0.0, 0.1)
    volts = 3.0 * np.broadcast_to([right, left], (ROWS * PARTS, 1, 2))
    turned = counted_turns(model, volts, ROW_S, np.zeros(1), WheelLoad(OWN, body), PARTS).cumsum(axis=0)[:, 0, 0]

    motor = Driveline.of_robot(model)
    damping, inertia = motor.damping_N_m_s_rad[0], motor.inertia_kg_m2[0] + OWN + right * left * OTHER
    speed = (motor.stall_torque_N_m(np.array([3.0, 3.0]))[0] - motor.coulomb_N_m[0]) / damping
    t_s, settles_s = ROW_S * np.arange(1, ROWS + 1), inertia / damping
    expected = speed * (t_s - settles_s * (1.0 - np.exp(-t_s / settles_s)))
    # The coupling changes the angle by 0.01 rad and more; it is taken from a first step without it.
    assert turned == pytest.approx(expected, abs=0.0015)


class TestTorqueThatChangesWithTheSpeed:
    """The run-up of a fast motor, of 14 ms, in rows of 50 ms: exponential with the damping that the effects leave."""

    R, K, B, TC, J, SUPPLY_V = 3.0, 0.5, 0.002, 0.02, 1.2e-3, 8.0

    @pytest.fixture
    def motor(self, robot):
        numbers = {
            "winding_resistance_ohm": self.R,
            "torque_constant_N_m_A": self.K,
            "viscous_friction_N_m_s_rad": self.B,
            "coulomb_friction_N_m": self.TC,
            "rotor_inertia_kg_m2": self.J,
        }
        power = robot.power.model_copy(update={"battery_voltage_V": self.SUPPLY_V})
        return robot.model_copy(update={"motor": robot.motor.model_copy(update=numbers), "power": power})

    def angles_rad(self, robot, volts):
        turned = counted_turns(RobotModel.from_config(robot), np.full((ROWS, 1, 2), volts), ROW_S, np.zeros(1))
        return turned.cumsum(axis=0)[:, 0, 0]

    @pytest.mark.parametrize("duty", [0.06, 0.2, 0.5, 0.9])
    def test_a_coasting_bridge_leaves_the_share_of_its_duty(self, motor, duty):
        """With hardly any inductance the supply drives for that share of the time: J w' = K D (S - K w) / R - B w - Tc.

        An error of 0.5 mrad in a row is one of 0.01 rad/s in its mean speed.
        """
        coasting = motor.with_effect(BridgeCoast(inductance_H=1e-12, diode_V=1.0))
        damping = self.B + duty * self.K**2 / self.R
        final, settles_s = (self.K * duty * self.SUPPLY_V / self.R - self.TC) / damping, self.J / damping
        t_s = ROW_S * np.arange(1, ROWS + 1)
        expected = final * (t_s - settles_s * (1.0 - np.exp(-t_s / settles_s)))
        angles_rad = self.angles_rad(coasting, duty * self.SUPPLY_V)
        np.testing.assert_allclose(np.diff(angles_rad, prepend=0.0), np.diff(expected, prepend=0.0), atol=5e-4)

    def test_a_current_that_stays_limited_gives_a_constant_torque(self, motor):
        """J w' = K I - B w - Tc; the speed stays far below the one at which the current would fall."""
        limit_A, t_s = 0.06, ROW_S * np.arange(1, ROWS + 1)
        settles_s = self.J / self.B
        final = (self.K * limit_A - self.TC) / self.B
        expected = final * (t_s - settles_s * (1.0 - np.exp(-t_s / settles_s)))
        angles_rad = self.angles_rad(motor.with_effect(CurrentLimit(limit_A=limit_A)), 8.0)
        np.testing.assert_allclose(np.diff(angles_rad, prepend=0.0), np.diff(expected, prepend=0.0), atol=5e-4)

    def test_a_robot_turns_the_same_beside_any_other_one(self, motor):
        """In one pass, a bridge of which steps must be corrected again or divided shares the arrays of the others."""
        volts = np.array([0.5, 6.0, -3.0, 0.3, 7.0, 0.0])[:, None, None] * np.ones((1, 2))
        robots = [motor.with_effect(BridgeCoast(inductance_H=i, diode_V=1.0)) for i in (1e-9, 3e-6, 3e-5, 3e-4, 5e-3)]

        def turned(some):
            return counted_turns(RobotModel.from_config(stacked(some, axes=2)), volts, ROW_S, np.zeros(1))

        together = turned(robots)
        for k, robot in enumerate(robots):
            alone = turned([robot])
            np.testing.assert_allclose(together[:, k], alone, rtol=1e-12)


def test_a_wheel_at_a_constant_voltage_follows_a_supply_that_the_other_one_changes():
    """While one wheel reverses, the supply of both changes within a row: the same as in rows a hundred times finer."""
    robot = draw_robot(load_section("robot", "nominal"), 1, "test")[0]
    light = robot.motor.model_copy(update={"rotor_inertia_kg_m2": robot.motor.rotor_inertia_kg_m2 / 8.0})
    robot = robot.model_copy(update={"motor": light}).with_effect(SupplySag(source_resistance_ohm=1.0))
    model, finer = RobotModel.from_config(robot.with_effect(CurrentLimit(limit_A=0.2))), 100
    other = np.repeat([5.0, -4.0, 2.0, -5.0, 0.5, 4.5], 4)
    volts = np.stack([np.full(len(other), 4.0), other], axis=1)[:, None]
    turned = counted_turns(model, volts, ROW_S, np.zeros(1))[:, 0]
    fine = counted_turns(model, np.repeat(volts, finer, axis=0), ROW_S / finer, np.zeros(1))
    expected = fine.reshape(len(other), finer, 2).sum(axis=1)
    np.testing.assert_allclose(turned / ROW_S, expected / ROW_S, atol=0.02)


class TestUnevenRows:
    """Rows that last unequally long, against exact steps from each change of the voltage to the next."""

    LASTS_S = np.array([[0.05, 0.047], [0.053, 0.05], [0.046, 0.055], [0.05, 0.05], [0.058, 0.049], [0.044, 0.05]])
    """Of six rows of two trials."""
    VOLTS = np.array([3.0, -1.0, 0.0, 4.0, 4.0, 1.5])

    def exact_rad(self, robot, lasts_s, delay_s):
        """Angles that the right wheel turns in each row."""
        motor = RobotModel.from_config(robot).motors.right
        begins_s = np.append(0.0, np.cumsum(lasts_s))
        changes_s = begins_s[:-1] + delay_s
        times_s = np.unique(np.concatenate([begins_s, changes_s[changes_s < begins_s[-1]]]))
        speed, turned = 0.0, np.zeros(len(lasts_s))
        for begin_s, end_s in pairwise(times_s.tolist()):
            row = int(np.searchsorted(changes_s, begin_s, side="right")) - 1
            volts = self.VOLTS[row] if row >= 0 else 0.0
            speed, further = motor.step(volts, speed, end_s - begin_s)
            turned[int(np.searchsorted(begins_s, begin_s, side="right")) - 1] += further
        return turned

    @pytest.mark.parametrize("parts", [1, 2])
    @pytest.mark.parametrize("delay_s", [0.0, 0.013, 0.07])
    def test_each_row_is_an_exact_step_of_its_own_duration(self, robot, delay_s, parts):
        model = RobotModel.from_config(robot.with_effect(InputDelay(delay_s=delay_s)))
        volts = np.repeat(np.tile(self.VOLTS[:, None, None], (1, 2, 2)), parts, axis=0)
        turned = counted_turns(model, volts, self.LASTS_S, np.zeros(2), parts=parts)
        expected = [self.exact_rad(robot, lasts_s, delay_s) for lasts_s in self.LASTS_S.T]
        np.testing.assert_allclose(turned[..., 0], np.transpose(expected), rtol=1e-9, atol=1e-12)

    @pytest.mark.parametrize("delay_s", [0.0, 0.013, 0.07])
    def test_a_voltage_that_lags_relaxes_from_each_change_to_the_next(self, robot, delay_s):
        time_constant_s = 0.03
        driveline = Driveline.of_robot(
            RobotModel.from_config(robot.with_effect(ActuatorLag(time_constant_s=time_constant_s)))
        )
        volts = np.tile(self.VOLTS[:, None, None], (1, 2, 2))
        held = HeldVoltages.from_commands(driveline, volts, self.LASTS_S[..., None], delay_s, np.zeros((2, 1)))
        for trial, lasts_s in enumerate(self.LASTS_S.T):
            ends_s = np.cumsum(lasts_s)
            since_s = ends_s[:, None] - (ends_s - lasts_s + delay_s)
            shares = -np.expm1(-np.maximum(since_s, 0.0) / time_constant_s)
            expected = shares @ np.diff(self.VOLTS, prepend=0.0)
            np.testing.assert_allclose(held.last_V[:, trial, 0], expected, rtol=1e-9)

    @pytest.mark.parametrize("effect", [BridgeCoast(inductance_H=1e-4, diode_V=0.6), ActuatorLag(time_constant_s=0.01)])
    def test_equal_durations_give_what_one_duration_does(self, robot, effect):
        model, volts = RobotModel.from_config(robot.with_effect(effect)), np.tile(self.VOLTS[:, None, None], (1, 2, 2))
        one, each = (counted_turns(model, volts, row_s, np.zeros(2)) for row_s in (ROW_S, np.full((6, 2), ROW_S)))
        np.testing.assert_allclose(each, one, rtol=1e-9)

    def test_robots_with_other_delays_are_independent(self, robot):
        robots = [robot.with_effect(InputDelay(delay_s=delay_s)) for delay_s in (0.002, 0.06)]
        volts = np.tile(self.VOLTS[:, None, None], (1, 2, 2))
        together = counted_turns(RobotModel.from_config(stacked(robots, axes=2)), volts, self.LASTS_S, np.zeros(2))
        alone = [counted_turns(RobotModel.from_config(each), volts, self.LASTS_S, np.zeros(2)) for each in robots]
        np.testing.assert_allclose(np.moveaxis(together, 1, 0), alone, rtol=1e-9)
