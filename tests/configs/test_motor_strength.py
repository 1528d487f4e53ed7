"""Motors that stop the pitching body within a physics step: from which strength on, and what the message proposes."""

import math

import pytest

from configs.checks.motor_strength import strength_faults
from configs.draw import draw_robot
from configs.loader import load_section
from configs.schema.robot import RobotConfig
from configs.schema.scenario import Rates
from symolo.core.yaml.tree import dotted

LITTLE = 1e-6


@pytest.fixture(scope="module")
def robot() -> RobotConfig:
    return draw_robot(load_section("robot", "nominal"), 1)[0]


def changed(robot: RobotConfig, **motor: float) -> RobotConfig:
    """Return a robot whose body pitches with 1.2 / 12 * (0.2^2 + 0.05^2) = 4.25e-3 kg m2."""
    body = {"mass_kg": 1.2, "length_m": 0.2, "base_height_m": 0.06, "clearance_m": 0.01}
    numbers = {"winding_resistance_ohm": 3.0, "viscous_friction_N_m_s_rad": 0.02} | motor
    chassis = robot.chassis.model_copy(update=body)
    return robot.model_copy(update={"chassis": chassis, "motor": robot.motor.model_copy(update=numbers)})


@pytest.mark.parametrize(("share", "has_fault"), [(1.0 + LITTLE, True), (1.0 - LITTLE, False)])
def test_motors_may_stop_the_pitching_body_in_a_step_and_not_faster(robot, share, has_fault):
    """Both together damp it with 2 (K^2 / R + B), which is 4.25 N m s/rad here."""
    constant = math.sqrt(3.0 * (0.5 * 4.25 * share - 0.02))
    made = changed(robot, torque_constant_N_m_A=constant)
    assert bool(list(strength_faults(Rates(physics_hz=1000), made))) is has_fault


@pytest.mark.parametrize(
    ("physics_hz", "times", "needed_hz"),
    [(1000, 1.5, 2000), (1000, 2.5, 3000), (20000, 4.5, 100000), (20000, 5.5, 0)],
)
def test_motors_that_are_too_strong_get_the_next_multiple_of_the_steps_that_is_allowed(
    robot, physics_hz, times, needed_hz
):
    """They need `times` as many steps. A simulation has at most 100 kHz."""
    constant = math.sqrt(3.0 * (0.5 * 4.25e-3 * physics_hz * times - 0.02))
    made = changed(robot, torque_constant_N_m_A=constant)
    (fault,) = strength_faults(Rates(physics_hz=physics_hz), made)
    of_rate = fault.alternatives[-1]
    assert of_rate.cure.partition(", or ")[2] == (f"set rates.physics_hz to {needed_hz}" if needed_hz else "")


@pytest.mark.parametrize(("steps", "is_possible"), [(1.0 + LITTLE, True), (1.0 - LITTLE, False)])
def test_another_unit_is_named_if_the_motors_then_need_more_than_a_step(robot, steps, is_possible):
    """A constant that stops the body in about one step if it is in mN m/A."""
    constant = math.sqrt(3.0 * (0.5 * 4.25 / steps - 0.02))
    made = changed(robot, torque_constant_N_m_A=1000.0 * constant)
    (fault,) = strength_faults(Rates(physics_hz=1000), made)
    assert fault.cure.startswith(f"if it is in mN m/A, write {constant:.6g}") is is_possible


@pytest.mark.parametrize(
    ("name", "value", "unit"),
    [
        ("torque_constant_N_m_A", 0.9, ""),
        ("torque_constant_N_m_A", 10.0, ""),
        ("torque_constant_N_m_A", 10.1, "mN m/A"),
        ("winding_resistance_ohm", 0.051, ""),
        ("winding_resistance_ohm", 0.049, "kohm"),
        ("viscous_friction_N_m_s_rad", 0.49, ""),
        ("viscous_friction_N_m_s_rad", 0.51, "mN m s/rad"),
    ],
)
def test_numbers_of_usual_motors_are_in_the_unit_that_they_should_have(robot, name, value, unit):
    """Up to 10 N m/A, from 50 mohm and up to 0.5 N m s/rad; each of these stops a light body within a millisecond."""
    light = robot.chassis.model_copy(update={"mass_kg": 0.01})
    others = {"torque_constant_N_m_A": 0.1, "winding_resistance_ohm": 3.0, "viscous_friction_N_m_s_rad": 1e-7}
    motor = robot.motor.model_copy(update=others | {name: value})
    made = robot.model_copy(update={"chassis": light, "motor": motor})
    (fault,) = strength_faults(Rates(physics_hz=1000), made)
    by_field = {dotted(each.path): each for each in (fault, *fault.alternatives)}
    assert by_field[f"robot.motor.{name}"].cure.startswith(f"if it is in {unit}, " if unit else "check the motor's")


@pytest.mark.parametrize(("friction", "first"), [(0.99, "torque_constant_N_m_A"), (1.01, "viscous_friction_N_m_s_rad")])
def test_the_larger_part_of_the_damping_is_named(robot, friction, first):
    """K^2 / R is 1 N m s/rad with 2 N m/A and 4 ohm."""
    made = changed(robot, torque_constant_N_m_A=2.0, winding_resistance_ohm=4.0, viscous_friction_N_m_s_rad=friction)
    (fault,) = strength_faults(Rates(physics_hz=500), made)
    assert dotted(fault.path) == f"robot.motor.{first}"
