"""Before and after by PyBullet, of benches and drives whose robot is known."""

from pathlib import Path

import numpy as np
import pytest

from configs.draw import draw_robot
from configs.loader import load_section
from diagnosis.engine.base import by_pybullet, by_twin, without_body
from diagnosis.engine.gain import compare_engines
from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from diagnosis.nominal_robot import nominal_robot
from physics.effects.motor_and_gearbox.torque_constant_scale import TorqueConstantScale
from physics.effects.wheels_and_floor.wheel_radius_scale import WheelRadiusScale


@pytest.fixture(scope="module")
def robot():
    return draw_robot(load_section("robot", "nominal"), 0, "test")[0]


def test_a_bench_of_a_weak_magnet_loses_its_error_in_pybullet_as_in_the_twin(motor_bench_case, robot, tmp_path):
    """The closed form's readings; noise of 1 mA and 0.04 rad/s is all that is left."""
    measured = read_measurement(motor_bench_case(tmp_path / "weak", strength=0.9), IMPORTERS)
    nominal = nominal_robot(measured.nominal, robot)
    comparison = compare_engines(measured, nominal, nominal.with_effect(TorqueConstantScale(scale=0.9)))
    bullet, twin = comparison.engines
    current, speed = bullet.errors
    assert current.before > 0.005
    assert current.after < 0.0015
    assert speed.before > 0.3
    assert speed.after < 0.06
    assert bullet.whole.value == pytest.approx(twin.whole.value, abs=0.01)
    assert bullet.whole.low <= bullet.whole.value <= bullet.whole.high


def test_a_drive_of_the_twin_is_driven_again_by_the_robot_it_was_and_not_by_another(robot, driven_log):
    smaller = robot.with_effect(WheelRadiusScale(scale=0.95))
    measured = driven_log(smaller)
    bullet, twin = compare_engines(measured, robot, smaller).engines
    assert twin.errors[2].after == pytest.approx(0.0, abs=1e-9)
    ahead = bullet.errors[2]
    assert ahead.quantity == "pose_dx_m"
    assert ahead.after < 0.05 * ahead.before


def test_the_path_begins_where_it_was_measured_and_leaves_it_by_the_share_that_the_wheels_are_too_large(
    robot, driven_log
):
    """Straight on, a radius of 1/0.95 goes 5.3 % too far, less what a hard start takes of it."""
    smaller = robot.with_effect(WheelRadiusScale(scale=0.95))
    path = compare_engines(driven_log(smaller, straight=True), robot, smaller).path
    np.testing.assert_allclose(path.nominal[0], path.measured[0], atol=1e-9)
    way_m = np.hypot(*path.measured[-1, :2])
    assert path.off_m(path.nominal)[-1] == pytest.approx(way_m * (1.0 / 0.95 - 1.0), rel=0.08)
    assert path.off_m(path.extended)[-1] < 0.01 * way_m


def test_a_case_s_motor_with_the_body_in_its_numbers_is_as_quick_with_the_body_beside_it(robot):
    """Time to 63 %, with the whole inertia in the motor and none in the body, and by PyBullet with the body apart."""
    whole = robot.model_copy(update={"motor": robot.motor.model_copy(update={"rotor_inertia_kg_m2": 3e-3})})
    motor = whole.motor
    damping = motor.torque_constant_N_m_A**2 / motor.winding_resistance_ohm + motor.viscous_friction_N_m_s_rad
    turned = by_pybullet(without_body(whole), np.full((100, 2), 3.0), 0.01).counts[:, 0]
    speed = np.diff(turned).astype(float)
    reached_s = 0.01 * np.interp(0.632 * speed[-1], speed[:40], 0.5 + np.arange(40))
    assert reached_s == pytest.approx(3e-3 / damping, rel=0.05)


def test_what_cannot_be_driven_says_why(robot):
    comparison = compare_engines(read_measurement(Path("table-3"), IMPORTERS), robot, robot)
    assert "nothing moves" in comparison.why_not
    assert comparison.engines == ()


def test_both_engines_start_where_the_robot_was(robot):
    """A floor may be another one at another place, so that the path is that of the room and not of the origin."""
    start, volts = (1.2, -0.4, 0.5 * np.pi), np.full((20, 2), 3.0)
    for drive in (by_pybullet, by_twin):
        ahead, there = drive(robot, volts, 0.05).pose, drive(robot, volts, 0.05, start).pose
        np.testing.assert_allclose(there[:, :2], np.array(start[:2]) + ahead[:, 1::-1] * [-1.0, 1.0], atol=2e-3)
        np.testing.assert_allclose(there[:, 2], start[2] + ahead[:, 2], atol=2e-3)
