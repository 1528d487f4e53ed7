"""Turns of wheels under the load of a body, which follow from its motion forward and around itself."""

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.loader import load_section
from physics.drivetrain.driveline import Driveline
from physics.drivetrain.wheel_turns import WheelLoad, counted_turns
from physics.robot.body_inertia import BodyOnWheels
from physics.robot.model import RobotModel

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
