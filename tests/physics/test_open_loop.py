"""Open loops in PyBullet against closed forms, and against the wheels that feel their body without an engine."""

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.loader import load_section
from physics.bullet.open_loop import open_loop
from physics.drivetrain.wheel_turns import NO_LOAD, WheelLoad, counted_turns
from physics.robot.model import RobotModel

ROW_S = 0.05


@pytest.fixture(scope="module")
def robot():
    return draw_robot(load_section("robot", "nominal"), 0, "test")[0]


def test_a_lifted_wheel_spins_up_by_the_time_constant_of_its_motor(robot):
    """Eq. 20 with dry friction: w = w_end (1 - exp(-t/T)), T = J R / (K^2 + R B), J with the wheel's own m r^2 / 2."""
    motor, drive = robot.motor, robot.drive
    R, K, B = motor.winding_resistance_ohm, motor.torque_constant_N_m_A, motor.viscous_friction_N_m_s_rad
    damping = K**2 / R + B
    inertia = motor.rotor_inertia_kg_m2 + 0.5 * drive.wheel_mass_kg * (0.5 * drive.wheel_diameter_m) ** 2
    end = (K * 3.0 / R - motor.coulomb_friction_N_m) / damping
    motion = open_loop(robot, np.tile([3.0, 0.0], (40, 1)), 0.005, lifted=True)
    expected = end * (1.0 - np.exp(-0.005 * np.arange(41) * damping / inertia))
    np.testing.assert_allclose(motion.wheel_speed_rad_s[:, 0], expected, atol=0.01 * end)
    np.testing.assert_allclose(motion.wheel_speed_rad_s[:, 1], 0.0, atol=1e-7)
    assert motion.current_A[-1, 0] == pytest.approx((3.0 - K * motion.wheel_speed_rad_s[-1, 0]) / R)


def test_both_wheels_alike_drive_straight_on_as_far_as_they_roll(robot):
    motion = open_loop(robot, np.full((20, 2), 3.0), ROW_S)
    rolled_m = 0.5 * robot.drive.wheel_diameter_m * 2.0 * np.pi * motion.counts[-1] / 3840
    assert motion.pose[-1, 0] == pytest.approx(rolled_m.mean(), rel=0.01)  # a hard start slips a little
    assert motion.pose[-1, 1:] == pytest.approx((0.0, 0.0), abs=1e-4)


def test_in_a_turn_wheels_feel_their_body_without_an_engine_as_in_it(robot):
    """A centre of mass behind the axle: 0.9 kg at -0.03 m turning with 3 rad/s pulls each wheel with some mN m."""
    voltage = np.tile([3.0, 1.0], (40, 1))
    counts = open_loop(robot, voltage, ROW_S).counts
    engine = (counts[-1] - counts[-11]) / 10 / 3840 * 2.0 * np.pi
    model = RobotModel.from_config(robot)
    body = WheelLoad.from_model(model)
    fast, slow = counted_turns(model, voltage[:, None], ROW_S, np.zeros(1), body)[-1, 0]
    assert (fast, slow) == pytest.approx(tuple(engine), abs=5e-4)
    _, without = counted_turns(model, voltage[:, None], ROW_S, np.zeros(1), NO_LOAD)[-1, 0]
    assert abs(without - engine[1]) > 3e-3
