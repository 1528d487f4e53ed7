"""Wheels that accelerate each other through the body, against the two modes of a linear model.

Both wheels alike have the inertia J + M, and against each other J - M, where M is the inertia between the wheels. The
simulation is exact to the first order of M / J.
"""

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.loader import load_section
from physics.drivetrain.wheel_turns import WheelLoad, counted_turns
from physics.robot.model import RobotModel

R, K, B, J = 3.0, 0.3, 0.002, 0.003
DAMPING = K * K / R + B
ROW_S = 0.005


@pytest.mark.parametrize(("side", "sign"), [(1.0, 1.0), (-1.0, -1.0)])
@pytest.mark.parametrize("mutual", [0.05, -0.05])
def test_coupled_wheels_have_the_time_constants_of_both_modes(side, sign, mutual):
    motor = {
        "winding_resistance_ohm": R, "torque_constant_N_m_A": K, "viscous_friction_N_m_s_rad": B,
        "coulomb_friction_N_m": 0.0, "rotor_inertia_kg_m2": J,
    }  # fmt: skip
    robot = draw_robot(load_section("robot", "nominal"), 1, "test")[0].with_section("motor", motor)
    model = RobotModel.from_config(robot)
    inertia = float(model.motors.left.inertia_kg_m2)
    voltage_V = np.tile([2.0, 2.0 * side], (200, 1, 1))
    turns = counted_turns(model, voltage_V, ROW_S, np.zeros(1), WheelLoad(mutual_kg_m2=mutual * inertia))
    tau_s = inertia * (1.0 + sign * mutual) / DAMPING
    t_s = ROW_S * np.arange(1, 201)
    expected = K * 2.0 / (R * DAMPING) * (t_s - tau_s * (1.0 - np.exp(-t_s / tau_s)))
    np.testing.assert_allclose(np.cumsum(turns[:, 0, 0]), expected, rtol=2.0 * mutual**2)
