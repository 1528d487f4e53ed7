from xml.etree import ElementTree as ET

import pytest

from physics.robot.urdf import robot_urdf


def numbers(text: str) -> list[float]:
    return [float(value) for value in text.split()]


@pytest.fixture(scope="module")
def tree(robot):
    return ET.fromstring(robot_urdf(robot))  # noqa: S314 - text that was written a line above


def joint_origin(tree, child: str) -> list[float]:
    joint = next(j for j in tree.iter("joint") if j.find("child").get("link") == child)
    return numbers(joint.find("origin").get("xyz"))


def test_the_text_is_the_same_for_the_same_robot(robot):
    assert robot_urdf(robot) == robot_urdf(robot.model_copy(deep=True))


def test_masses_add_up_to_the_configured_robot_and_its_caster_ball(robot, tree):
    total = sum(float(mass.get("value")) for mass in tree.iter("mass"))
    assert total == pytest.approx(robot.chassis.mass_kg + 2 * robot.drive.wheel_mass_kg, abs=2e-3)


def test_wheels_and_caster_stand_on_the_floor_at_the_configured_places(robot, tree):
    drive = robot.drive
    radius = 0.5 * drive.wheel_diameter_m
    assert joint_origin(tree, "right_wheel") == pytest.approx([0.0, -0.5 * drive.track_m, radius])
    assert joint_origin(tree, "left_wheel") == pytest.approx([0.0, 0.5 * drive.track_m, radius])
    assert joint_origin(tree, "caster") == pytest.approx([drive.caster_x_m, 0.0, drive.caster_radius_m])
    radii = [float(sphere.get("radius")) for sphere in tree.iter("sphere")]
    assert radii == [radius, radius, drive.caster_radius_m]


def test_the_chassis_is_the_footprint_and_encloses_the_wheels(robot, tree):
    length, width, _ = numbers(next(tree.iter("box")).get("size"))
    assert (length, width) == (robot.chassis.length_m, robot.chassis.width_m)
    assert width >= robot.drive.track_m + robot.drive.wheel_width_m


def test_every_inertia_is_that_of_a_possible_body(tree):
    # PyBullet puts zero, with no more than a line on the console, for one that breaks the triangle inequality.
    for inertia in tree.iter("inertia"):
        xx, yy, zz = sorted(float(inertia.get(name)) for name in ("ixx", "iyy", "izz"))
        assert xx > 0.0
        assert xx + yy >= zz


def test_joint_damping_is_back_emf_and_viscous_friction(robot, tree):
    motor = robot.motor
    expected = motor.torque_constant_N_m_A**2 / motor.winding_resistance_ohm + motor.viscous_friction_N_m_s_rad
    assert [float(d.get("damping")) for d in tree.iter("dynamics")] == pytest.approx([expected, expected])
