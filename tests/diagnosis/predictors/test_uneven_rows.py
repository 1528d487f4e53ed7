"""Wheels in rows that last unequally long, whose motors take an exact step in each of them."""

import math

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.loader import load_section
from diagnosis.nominal_robot import nominal_robot
from physics.drivetrain.motor import MotorModel
from tests.diagnosis.predictors.driven_wheels import NOMINAL, ROW_S, TC, TICKS, B, J, K, R, wheels

ROWS = 600
MOTOR = MotorModel(R, K, B, TC, J)


@pytest.fixture(scope="module")
def robot():
    return nominal_robot(NOMINAL, draw_robot(load_section("robot", "nominal"), 1, "test")[0])


def turned_rad(voltage_V, t_s):
    """Angles (n,) at some times of a motor whose voltages are held from each time to the next."""
    speed, angles = 0.0, [0.0]
    for volts, lasts_s in zip(voltage_V[:-1].tolist(), np.diff(t_s).tolist(), strict=True):
        speed, turned = MOTOR.step(volts, speed, lasts_s)
        angles.append(angles[-1] + turned)
    return np.array(angles)


def residuals(robot, t_s, voltage_V):
    angle_rad = np.stack([turned_rad(each, t_s) for each in voltage_V.T], axis=-1)
    stage = wheels(robot, voltage_V, angle_rad, t_s)
    (predicted,) = [stage.predict([robot])]
    return [of.values - each.mean[0] for of, each in zip(stage.observed, predicted, strict=True)]


@pytest.mark.parametrize("jitter_s", [0.0, 0.001])
def test_only_the_rounding_of_the_counts_is_left(robot, jitter_s):
    """The speed changes by up to 5 rad/s in a row, by a voltage that acts a thousandth of a second early or late."""
    random = np.random.Generator(np.random.PCG64(5))
    t_s = ROW_S * np.arange(ROWS) + np.append(0.0, random.normal(0.0, jitter_s, ROWS - 1))
    voltage_V = np.repeat(random.uniform(-5.0, 5.0, (ROWS // 4, 2)), 4, axis=0)
    rounding_rad_s = math.tau / TICKS / ROW_S / math.sqrt(6.0)
    for each in residuals(robot, t_s, voltage_V):
        assert np.sqrt(np.nanmean(each**2)) == pytest.approx(rounding_rad_s, rel=0.1)
